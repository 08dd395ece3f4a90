// SPDX-License-Identifier: Apache-2.0
// Bounds how far bodies can move towards each other in a step (CA-1) to (CA-3).
#pragma once

#include "geometry/se3.hpp"

namespace aussois {

/// A rigid body on the path that the integrator defines: the reference point (the centre of mass) moves on a
/// straight line, the rotation is R exp(s omega): constant angular velocity in space and in the body.
struct RigidMotion {
  SE3 g{};                    // body frame in the world at s = 0
  Vec3 v = Vec3::Zero();      // of the reference point, world [m/s]
  Vec3 omega = Vec3::Zero();  // body frame [rad/s]
};

SE3 pose_at(const RigidMotion& motion, double s);
/// What is left of the path after the time s: the same velocities, from the pose there.
RigidMotion motion_after(const RigidMotion& motion, double s);

/// Largest displacement of any point within `radius` of the reference point during dt, for all intermediate
/// times (CA-1) [m].
double displacement_bound(const RigidMotion& motion, double radius, double dt);

/// Largest displacement of a point of one body seen from the other, at all times in [0, dt]: the smallest of
/// the sum of both displacements and the relative bounds with either body as the observer (CA-2) [m].
double relative_displacement_bound(const RigidMotion& a, double radius_a, const RigidMotion& b,
                                   double radius_b, double dt);

/// Bound of the angle of the relative rotation during dt (CA-3) [rad].
double relative_rotation_bound(const RigidMotion& a, const RigidMotion& b, double dt);

/// A body in a step, with all that the bounds of its pairs need from it alone.
struct MovingBody {
  RigidMotion motion{};
  double radius = 0;        // of its points about the reference point [m]
  Vec3 w = Vec3::Zero();    // angular velocity, world [rad/s]
  double spin = 0;          // |w|
  double displacement = 0;  // (CA-1), `stretch` included [m]
  // Bounds of its deformation, seen from the body: how far any point moves, and how far any normal turns
  double stretch = 0;  // [m]
  double bend = 0;     // [rad]
};
MovingBody moving_body(const RigidMotion& motion, double radius, double dt);

struct RelativeBounds {
  double displacement = 0;  // (CA-2) [m]
  double rotation = 0;      // (CA-3) [rad]
};
/// Both bounds of a pair at once, bit for bit those of the functions above.
RelativeBounds relative_bounds(const MovingBody& a, const MovingBody& b, double dt);

/// Data for how far points of A can move towards B along a direction that B carries with it (CA-13); a slide
/// does not add to it, however fast. Everything in the world frame at the start of the step.
struct Approach {
  Vec3 o_a = Vec3::Zero(), o_b = Vec3::Zero();  // reference points [m]
  Vec3 v_ab = Vec3::Zero();                     // v_a - v_b [m/s]
  Vec3 w_a = Vec3::Zero(), w_b = Vec3::Zero();  // [rad/s]
  double dt = 0;                                // [s]
};
Approach approach_of(const RigidMotion& a, const RigidMotion& b, double dt);

/// Bound of the acceleration, seen from B, of the points of A that start in the ball (CA-14) [m/s^2].
double acceleration_bound(const Approach& approach, const Vec3& centre, double radius);

/// Bound for the points of A that start in the ball, for all unit directions from A to B that start within
/// `half_angle` of `axis`, and for all times of the step [m], >= 0. Simplices whose distance exceeds it by d
/// stay farther apart than d. The bound is tightest if B, the observer, is the body that turns less.
double approach_bound(const Approach& approach, const Vec3& centre, double radius, const Vec3& axis,
                      double half_angle);

}  // namespace aussois
