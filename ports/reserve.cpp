// SPDX-License-Identifier: Apache-2.0
#include "ports/reserve.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/settings.hpp"
#include "geometry/so3.hpp"

namespace aussois {

void describe(SettingVisitor& visit, ReserveOptions& o) {
  visit.begin("ReserveOptions");
  visit.number({"lend", "energy that may leave beyond what is stored", "J", not_negative_range(), "--lend"},
               o.lend);
  visit.number({"acceleration", "largest acceleration of the handle", "m/s^2", positive_range()},
               o.acceleration);
  visit.number({"rotation", "largest rotational acceleration of the handle", "rad/s^2", positive_range()},
               o.rotation);
  visit.number({"count", "count of the encoders of position", "m", not_negative_range()}, o.count);
  visit.number({"rotation_count", "count of the encoders of rotation", "rad", not_negative_range()},
               o.rotation_count);
  visit.number({"period", "time between two samples of the device", "s", positive_range()}, o.period);
}

void validate(const ReserveOptions& options) {
  check_ranges(options);
}

DeviceMotion motion_between(const SE3& from, const SE3& to) {
  return {to.p - from.p, from.R * log_so3((from.R.conjugate() * to.R).normalized())};
}

namespace {

// What the logarithm of a turn by `turn` may lack of the turns in it, with a torque of 1 N m [rad].
double hidden_turn(double turn, const ReserveOptions& o) {
  const double more = o.rotation * o.period * o.period;
  return (turn + more) * more / 12;
}

// Of numbers that encoders round: how much their second difference may be off, along a force.
double rounded(const Vec3& force, double count) {
  return 2 * count * force.lpNorm<1>();
}

bool finite(const DeviceForce& f) {
  return f.force.allFinite() && f.torque.allFinite();
}

}  // namespace

double work_left(const DeviceForce& held, const DeviceMotion& motion, const ReserveOptions& options) {
  return held.force.dot(motion.shift) + held.torque.dot(motion.turn) +
         held.torque.norm() * hidden_turn(motion.turn.norm(), options);
}

Reserve after_sample(Reserve reserve, double left, double put_in) {
  reserve.level += put_in - left;
  reserve.negative += !(reserve.level >= 0);
  return reserve;
}

Reserve after_tick(Reserve reserve, double stored, const ReserveOptions& options) {
  reserve.level = std::min(reserve.level, stored + options.lend);
  return reserve;
}

Valve let_through(const DeviceForce& wish, const DeviceMotion& last, Reserve reserve,
                  const ReserveOptions& options) {
  if (!finite(wish) || !std::isfinite(reserve.level)) {
    ++reserve.refused;
    return {{}, reserve};
  }
  const double more = options.acceleration * options.period * options.period,
               turn = last.turn.norm() + options.rotation * options.period * options.period;
  const double leave = wish.force.dot(last.shift) + wish.torque.dot(last.turn) + wish.force.norm() * more +
                       rounded(wish.force, options.count) +
                       wish.torque.norm() * (options.rotation * options.period * options.period +
                                             3 * hidden_turn(turn, options)) +
                       rounded(wish.torque, options.rotation_count);
  if (leave <= std::max(0.0, reserve.level)) return {wish, reserve};
  if (!(reserve.level > 0)) {
    ++reserve.stopped;
    return {{}, reserve};
  }
  ++reserve.scaled;
  const double part = reserve.level / leave;
  return {{part * wish.force, part * wish.torque}, reserve};
}

}  // namespace aussois
