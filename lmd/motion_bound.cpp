// SPDX-License-Identifier: Apache-2.0
#include "lmd/motion_bound.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace aussois
