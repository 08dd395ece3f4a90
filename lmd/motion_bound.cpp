// SPDX-License-Identifier: Apache-2.0
#include "lmd/motion_bound.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace aussois {
namespace {

// Points of a (within radius_a of its reference point) seen from b; constant v and omega on the step.
double seen_from(const RigidMotion& a, double radius_a, const RigidMotion& b, double dt) {
  const Vec3 w_a = a.g.R * a.omega, w_b = b.g.R * b.omega, r0 = a.g.p - b.g.p;
  return dt * ((a.v - b.v - w_b.cross(r0)).norm() + (w_a - w_b).norm() * radius_a) +
         dt * dt / 2 * w_b.norm() * (a.v - b.v).norm();
}

}  // namespace

SE3 pose_at(const RigidMotion& motion, double s) {
  return {(motion.g.R * exp_so3(s * motion.omega)).normalized(), motion.g.p + s * motion.v};
}

double displacement_bound(const RigidMotion& motion, double radius, double dt) {
  return motion.v.norm() * dt + 2 * radius * std::sin(std::min(motion.omega.norm() * dt, kPi) / 2);
}

double relative_displacement_bound(const RigidMotion& a, double radius_a, const RigidMotion& b,
                                   double radius_b, double dt) {
  return std::min({displacement_bound(a, radius_a, dt) + displacement_bound(b, radius_b, dt),
                   seen_from(a, radius_a, b, dt), seen_from(b, radius_b, a, dt)});
}

double relative_rotation_bound(const RigidMotion& a, const RigidMotion& b, double dt) {
  return dt * (a.g.R * a.omega - b.g.R * b.omega).norm();
}

Approach approach_of(const RigidMotion& a, double radius_a, const RigidMotion& b, double dt) {
  const Vec3 w_a = a.g.R * a.omega, w_b = b.g.R * b.omega;
  const double rate_a = w_a.norm(), rate_b = w_b.norm(), v_ab = (a.v - b.v).norm();
  const double farthest = (a.g.p - b.g.p).norm() + dt * v_ab + radius_a;  // from B's reference point
  const double acceleration =
      rate_a * rate_a * radius_a + 2 * rate_b * (v_ab + rate_a * radius_a) + rate_b * rate_b * farthest;
  return {.v = a.v - b.v - w_a.cross(a.g.p) + w_b.cross(b.g.p),
          .omega = w_a - w_b,
          .bend = dt * dt / 2 * acceleration,
          .dt = dt};
}

double approach_bound(const Approach& approach, const Vec3& centre, double radius, const Vec3& axis,
                      double half_angle) {
  const Vec3 v = approach.v + approach.omega.cross(centre);
  const double speed = v.norm(), along = axis.dot(v), across = axis.cross(v).norm();
  // The largest u . v of the cap: v's own direction if it lies inside, else that of the rim below it.
  const double turn = std::atan2(across, along);
  const double fastest = turn <= half_angle ? speed : speed * std::cos(turn - half_angle);
  return std::max(0.0, approach.dt * (fastest + approach.omega.norm() * radius) + approach.bend);
}

}  // namespace aussois
