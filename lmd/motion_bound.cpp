// SPDX-License-Identifier: Apache-2.0
#include "lmd/motion_bound.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace aussois {
namespace {

// Points of a seen from b; constant v and omega on the step. `turn` and `speed`: |w_a - w_b| and |v_a - v_b|.
double seen_from(const MovingBody& a, const MovingBody& b, double turn, double speed, double dt) {
  const Vec3 r0 = a.motion.g.p - b.motion.g.p;
  return dt * ((a.motion.v - b.motion.v - b.w.cross(r0)).norm() + turn * a.radius) +
         dt * dt / 2 * b.spin * speed;
}

}  // namespace

SE3 pose_at(const RigidMotion& motion, double s) {
  return {(motion.g.R * exp_so3(s * motion.omega)).normalized(), motion.g.p + s * motion.v};
}

RigidMotion motion_after(const RigidMotion& motion, double s) {
  return {.g = pose_at(motion, s), .v = motion.v, .omega = motion.omega};
}

double displacement_bound(const RigidMotion& motion, double radius, double dt) {
  return motion.v.norm() * dt + 2 * radius * std::sin(std::min(motion.omega.norm() * dt, kPi) / 2);
}

double relative_displacement_bound(const RigidMotion& a, double radius_a, const RigidMotion& b,
                                   double radius_b, double dt) {
  return relative_bounds(moving_body(a, radius_a, dt), moving_body(b, radius_b, dt), dt).displacement;
}

double relative_rotation_bound(const RigidMotion& a, const RigidMotion& b, double dt) {
  return dt * (a.g.R * a.omega - b.g.R * b.omega).norm();
}

MovingBody moving_body(const RigidMotion& motion, double radius, double dt) {
  const bool turns = !motion.omega.isZero(0);  // most bodies of many scenes do not
  const Vec3 w = turns ? Vec3(motion.g.R * motion.omega) : Vec3::Zero();
  return {.motion = motion,
          .radius = radius,
          .w = w,
          .spin = w.norm(),
          .displacement = displacement_bound(motion, radius, dt)};
}

RelativeBounds relative_bounds(const MovingBody& a, const MovingBody& b, double dt) {
  const double turn = (a.w - b.w).norm(), speed = (a.motion.v - b.motion.v).norm();
  const double stretch = a.stretch + b.stretch;
  return {
      .displacement = std::min({a.displacement + b.displacement, seen_from(a, b, turn, speed, dt) + stretch,
                                seen_from(b, a, turn, speed, dt) + stretch}),
      .rotation = dt * turn + (a.bend + b.bend)};
}

Approach approach_of(const RigidMotion& a, const RigidMotion& b, double dt) {
  return {.o_a = a.g.p,
          .o_b = b.g.p,
          .v_ab = a.v - b.v,
          .w_a = a.g.R * a.omega,
          .w_b = b.g.R * b.omega,
          .dt = dt};
}

double acceleration_bound(const Approach& m, const Vec3& centre, double radius) {
  const double rate_a = m.w_a.norm(), rate_b = m.w_b.norm();
  const double spin_a = m.w_a.cross(centre - m.o_a).norm() + rate_a * radius;
  const double spin_b = m.w_b.cross(centre - m.o_b).norm() + rate_b * radius;
  const double speed = m.v_ab.norm() + spin_a;
  return rate_a * spin_a + rate_b * (2 * speed + spin_b + rate_b * m.dt * speed);
}

double approach_bound(const Approach& m, const Vec3& centre, double radius, const Vec3& axis,
                      double half_angle) {
  const Vec3 turn_a = m.w_a.cross(centre - m.o_a), turn_b = m.w_b.cross(centre - m.o_b);
  const Vec3 v = m.v_ab + turn_a - turn_b;  // of the centre seen from B
  // The largest u . v of the cap: v's own direction if it lies inside, else that of the rim next to it.
  const double angle = std::atan2(axis.cross(v).norm(), axis.dot(v));
  const double along = v.norm() * std::cos(std::max(0.0, angle - half_angle));
  return std::max(0.0, m.dt * (along + (m.w_a - m.w_b).norm() * radius) +
                           m.dt * m.dt / 2 * acceleration_bound(m, centre, radius));
}

}  // namespace aussois
