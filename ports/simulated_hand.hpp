// SPDX-License-Identifier: Apache-2.0
// A hand on a device, both simulated: it reaches into what is in its way and back, and feels what it is given
// (doc/theory/ports.md).
#pragma once

#include <random>

#include "geometry/named.hpp"
#include "ports/reserve.hpp"

namespace aussois {

class SettingVisitor;

enum class HandKind {
  loose,   // hardly holds the handle: the worst for stability
  soft,    // near what arms were measured to be
  firm,    // holds tight
  rigid,   // goes where it wants, whatever it is given
  shaking  // the same, and sweeps through frequencies in search of a resonance
};
inline constexpr Named<HandKind> kHandKinds[] = {{HandKind::loose, "loose"},
                                                 {HandKind::soft, "soft"},
                                                 {HandKind::firm, "firm"},
                                                 {HandKind::rigid, "rigid"},
                                                 {HandKind::shaking, "shaking"}};

/// `describe` gives the ranges.
struct SimulatedDeviceOptions {
  double mass = 0.2;                               // of the handle [kg]
  double damping = 0.1;                            // [N s/m]
  double inertia = 1e-3, rotation_damping = 1e-4;  // about any axis [kg m^2], [N m s/rad]
  double count = 1e-5, rotation_count = 1e-4;      // of the encoders [m], [rad]
  double force_limit = 40, torque_limit = 3;       // [N], [N m]
  double period = 1e-3;                            // between two samples [s]
  double jitter = 0;                               // of the instant of a sample, part of the period [-]
  double lost = 0;                                 // part of the samples that bring no news [-]
};
void validate(const SimulatedDeviceOptions& options);
void describe(SettingVisitor& visit, SimulatedDeviceOptions& options);

/// Where a hand goes: from `home` along `into`, into what is in the way, and back.
struct Reaching {
  SE3 home{};                           // of the handle, free of everything [m]
  Vec3 into = -Vec3::UnitZ();           // unit, world
  double shallow = 1e-3, deep = 15e-3;  // how far beyond `home` [m]
  double back = 8e-3;                   // at most behind it [m]
  double aside = 0;                     // at most across [m]
  double turn = 0;                      // at most, about any axis [rad]
  double quick = 0.05, slow = 0.25;     // how long a reach takes [s]
  double pause = 0.15;                  // before the next, at most [s]
};

/// Holds a handle; the same seed does the same on any machine.
class SimulatedHand {
 public:
  SimulatedHand(HandKind kind, const SimulatedDeviceOptions& device, const Reaching& reaching,
                std::uint64_t seed);

  /// Lives for a period under this force, within the limits of the device, then reads the encoders.
  DeviceSample live(const DeviceForce& sent);

  double time() const { return time_; }
  double given() const { return given_; }  // energy that the hand was given, exact [J]
  std::int64_t pushes() const { return pushes_; }
  const SE3& handle() const { return handle_; }  // where it really is
  const DeviceForce& held() const { return held_; }

 private:
  void choose_reach();
  void wish(double dt);
  void move(double dt);
  double uniform(double from, double to);

  HandKind kind_;
  SimulatedDeviceOptions device_;
  Reaching reaching_;
  std::mt19937_64 random_;
  SE3 handle_{}, wanted_{}, before_{};  // before_: what was wanted a substep ago
  Vec3 velocity_ = Vec3::Zero(), spin_ = Vec3::Zero();
  SE3 from_{}, to_{};
  double begins_ = 0, ends_ = 0.1, phase_ = 0;
  bool inwards_ = false;
  double time_ = 0, given_ = 0;
  std::int64_t pushes_ = 0;
  std::uint64_t serial_ = 0;
  DeviceForce held_{};
  DeviceSample last_{};
};

/// The hand and its device behind the four functions; each reading lives for a period.
HapticDevice simulated_device(HandKind kind, const SimulatedDeviceOptions& device, const Reaching& reaching,
                              std::uint64_t seed);

}  // namespace aussois
