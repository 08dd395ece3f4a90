// SPDX-License-Identifier: Apache-2.0
#include "ports/simulated_hand.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "geometry/so3.hpp"
#include "mechanics/handle.hpp"

namespace aussois {
namespace {

constexpr int kSubsteps = 20;                   // of a period
constexpr double kSlowest = 3, kFastest = 150;  // of a shaking hand [Hz]
constexpr double kShake = 100;                  // its largest acceleration [m/s^2]
constexpr double kSwing = 5e-3;                 // and its largest way [m]
constexpr double kSweep = 8;                    // how long a sweep up and down takes [s]

// What holds the handle; no mass: it goes where the hand wants.
struct Arm {
  double mass = 0, damping = 0, stiffness = 0;               // [kg], [N s/m], [N/m]
  double inertia = 0, turn_damping = 0, turn_stiffness = 0;  // [kg m^2], [N m s/rad], [N m/rad]
};
Arm arm_of(HandKind kind) {
  switch (kind) {
    case HandKind::loose:
      return {0.1, 0.5, 100, 1e-4, 5e-4, 0.1};
    case HandKind::soft:
      return {0.5, 5, 300, 5e-4, 5e-3, 0.3};
    case HandKind::firm:
      return {1.5, 30, 1000, 1.5e-3, 3e-2, 1};
    case HandKind::rigid:
    case HandKind::shaking:
      break;
  }
  return {};
}

// From 0 to 1 with the least jerk.
double minimum_jerk(double s) {
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

SE3 between(const SE3& from, const SE3& to, double s) {
  return {from.R * exp_so3(s * log_so3((from.R.conjugate() * to.R).normalized())),
          from.p + s * (to.p - from.p)};
}

double counted(double value, double count) {
  return count > 0 ? count * std::round(value / count) : value;
}

}  // namespace

void describe(SettingVisitor& visit, SimulatedDeviceOptions& o) {
  visit.begin("SimulatedDeviceOptions");
  visit.number({"mass", "mass of the handle", "kg", positive_range()}, o.mass);
  visit.number({"damping", "damping of the device", "N s/m", not_negative_range()}, o.damping);
  visit.number({"inertia", "moment of inertia of the handle about any axis", "kg m^2", positive_range()},
               o.inertia);
  visit.number({"rotation_damping", "damping of its rotation", "N m s/rad", not_negative_range()},
               o.rotation_damping);
  visit.number({"count", "count of the encoders of position", "m", not_negative_range()}, o.count);
  visit.number({"rotation_count", "count of the encoders of rotation", "rad", not_negative_range()},
               o.rotation_count);
  visit.number({"force_limit", "largest force of the device", "N", positive_range()}, o.force_limit);
  visit.number({"torque_limit", "largest torque of the device", "N m", positive_range()}, o.torque_limit);
  visit.number({"period", "time between two samples", "s", positive_range()}, o.period);
  visit.number({"jitter", "jitter of the instant of a sample, part of the period", "-", {0, 0.5}}, o.jitter);
  visit.number({"lost", "part of the samples that are lost", "-", {0, 0.5}}, o.lost);
}

void validate(const SimulatedDeviceOptions& options) {
  check_ranges(options);
}

SimulatedHand::SimulatedHand(HandKind kind, const SimulatedDeviceOptions& device, const Reaching& reaching,
                             std::uint64_t seed)
    : kind_(kind),
      device_(device),
      reaching_(reaching),
      random_(seed),
      handle_(reaching.home),
      wanted_(reaching.home),
      before_(reaching.home),
      from_(reaching.home),
      to_(reaching.home) {
  validate(device);
  require_field(std::abs(reaching.into.norm() - 1) < 1e-9, "Reaching::into: length", reaching.into.norm(),
                "be 1");
  require_field(reaching.quick > 0 && reaching.quick <= reaching.slow, "Reaching::quick", reaching.quick,
                "be positive and not above slow [s]");
  last_.pose = reaching.home;
}

double SimulatedHand::uniform(double from, double to) {
  return from + (to - from) * double(random_() >> 11) * 0x1p-53;
}

void SimulatedHand::choose_reach() {
  inwards_ = !inwards_;
  pushes_ += inwards_;
  from_ = to_;
  const double along = inwards_ ? uniform(reaching_.shallow, reaching_.deep) : -uniform(0, reaching_.back);
  const Vec3 side(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)),
      turn(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
  const Vec3 across = side - side.dot(reaching_.into) * reaching_.into;
  to_.p = reaching_.home.p + along * reaching_.into + reaching_.aside * across;
  to_.R = exp_so3(reaching_.turn * turn) * reaching_.home.R;
  begins_ = time_ + (inwards_ ? 0 : uniform(0, reaching_.pause));
  ends_ = begins_ + uniform(reaching_.quick, reaching_.slow);
}

void SimulatedHand::wish(double dt) {
  before_ = wanted_;
  if (kind_ == HandKind::shaking) {
    const double up = std::abs(std::fmod(2 * time_ / kSweep + 1, 2) - 1);
    const double rate = 2 * kPi * (kSlowest + (kFastest - kSlowest) * up);
    const double swing = std::min({kSwing, kShake / (rate * rate), kSwing * time_});
    const double deep = (reaching_.shallow + reaching_.deep) / 2 * std::min(1.0, time_);
    const double last = std::sin(phase_), now = std::sin(phase_ += rate * dt);
    pushes_ += last < 0 && now >= 0;
    wanted_.p = reaching_.home.p + (deep + swing * now) * reaching_.into;
    return;
  }
  if (time_ > ends_) choose_reach();
  wanted_ = between(from_, to_, minimum_jerk(std::clamp((time_ - begins_) / (ends_ - begins_), 0.0, 1.0)));
}

void SimulatedHand::move(double dt) {
  const Arm arm = arm_of(kind_);
  const DeviceMotion missing = motion_between(handle_, wanted_), asked = motion_between(before_, wanted_);
  if (arm.mass == 0) {
    velocity_ = missing.shift / dt;
    spin_ = missing.turn / dt;
  } else {
    const auto pulled = [dt](double m, double b, double k, const Vec3& v, const Vec3& push) {
      return Vec3((v + dt / m * push) / (1 + dt * b / m + dt * dt * k / m));
    };
    velocity_ = pulled(arm.mass + device_.mass, arm.damping + device_.damping, arm.stiffness, velocity_,
                       held_.force + arm.stiffness * missing.shift + arm.damping * asked.shift / dt);
    spin_ =
        pulled(arm.inertia + device_.inertia, arm.turn_damping + device_.rotation_damping, arm.turn_stiffness,
               spin_, held_.torque + arm.turn_stiffness * missing.turn + arm.turn_damping * asked.turn / dt);
  }
  handle_.p += dt * velocity_;
  handle_.R = (exp_so3(dt * spin_) * handle_.R).normalized();
  given_ += dt * (held_.force.dot(velocity_) + held_.torque.dot(spin_));
}

DeviceSample SimulatedHand::live(const DeviceForce& sent) {
  held_ = {limited_pull(sent.force, device_.force_limit).pull,
           limited_pull(sent.torque, device_.torque_limit).pull};
  const double lasts = device_.period * (1 + device_.jitter * uniform(-1, 1)), dt = lasts / kSubsteps;
  for (int i = 0; i < kSubsteps; ++i) {
    time_ += dt;
    wish(dt);
    move(dt);
  }
  if (uniform(0, 1) < device_.lost) return last_;
  for (int i = 0; i < 3; ++i) last_.pose.p[i] = counted(handle_.p[i], device_.count);
  Vec3 turn = log_so3((reaching_.home.R.conjugate() * handle_.R).normalized());
  for (int i = 0; i < 3; ++i) turn[i] = counted(turn[i], device_.rotation_count);
  last_.pose.R = reaching_.home.R * exp_so3(turn);
  last_.time = time_;
  last_.serial = ++serial_;
  return last_;
}

HapticDevice simulated_device(HandKind kind, const SimulatedDeviceOptions& device, const Reaching& reaching,
                              std::uint64_t seed) {
  const auto hand = std::make_shared<SimulatedHand>(kind, device, reaching, seed);
  const auto force = std::make_shared<DeviceForce>();
  return {.name = std::string("simulated ") + name_of(kind, kHandKinds) + " hand",
          .open = [] {},
          .read = [=]() -> std::optional<DeviceSample> { return hand->live(*force); },
          .write = [=](const DeviceForce& sent) { *force = sent; },
          .close = [] {}};
}

}  // namespace aussois
