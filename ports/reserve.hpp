// SPDX-License-Identifier: Apache-2.0
// The reserve: what a hand can be given at most from any step of the bodies on, whatever forces are wished
// for (PORT-3), (PORT-4).
#pragma once

#include <cstdint>

#include "ports/device.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct ReserveOptions {
  double lend = 1e-2;            // what may leave beyond what is stored [J]
  double acceleration = 150;     // largest of the handle [m/s^2]
  double rotation = 3e3;         // largest of its rotation [rad/s^2]
  double count = 1e-5;           // of the encoders [m]
  double rotation_count = 1e-4;  // [rad]
  double period = 1e-3;          // between two samples [s]
};
void validate(const ReserveOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, ReserveOptions& options);

struct Reserve {
  double level = 0;           // [J]
  std::int64_t scaled = 0;    // samples whose force was made smaller
  std::int64_t stopped = 0;   // and those whose force was taken away, since nothing was left
  std::int64_t negative = 0;  // samples that left the level below zero: the handle was faster than its bounds
  std::int64_t refused = 0;   // forces that were no numbers
};

/// How the handle moved between two samples, in the world.
struct DeviceMotion {
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();  // [m, rad]
};
DeviceMotion motion_between(const SE3& from, const SE3& to);
/// A device that moves farther between two samples has jumped: its hand lets go.
inline constexpr double kDeviceJump = 5e-3, kDeviceTurn = 0.0873;  // [m], 5 degrees [rad]
inline bool has_jumped(const DeviceMotion& motion) {
  return !(motion.shift.norm() <= kDeviceJump && motion.turn.norm() <= kDeviceTurn);
}

/// What left with a force that was held over a motion, with what a turn that changes its axis may hide [J].
double work_left(const DeviceForce& held, const DeviceMotion& motion, const ReserveOptions& options);

/// After a sample with which `left` went out, and what sources `put_in` since the last [J], at least 0.
Reserve after_sample(Reserve reserve, double left, double put_in = 0);
/// After a step of the bodies: no more than is `stored` in them, and what is lent (PORT-3).
Reserve after_tick(Reserve reserve, double stored, const ReserveOptions& options);

struct Valve {
  DeviceForce force{};
  Reserve reserve{};
};
/// The part of a wished force that the reserve pays for until the next sample; `last` is the motion of the
/// last one (PORT-4).
Valve let_through(const DeviceForce& wish, const DeviceMotion& last, Reserve reserve,
                  const ReserveOptions& options);

}  // namespace aussois
