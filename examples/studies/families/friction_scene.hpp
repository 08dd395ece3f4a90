// SPDX-License-Identifier: Apache-2.0
// Bodies at one instant, what they touch and what joins them, and the one-step problem of that (FAM-1) to
// (FAM-4). Everything is in the world: no shapes, no search; contacts between blocks are the corners of the
// polygon that two facing faces share.
#pragma once

#include <vector>

#include "geometry/se3.hpp"
#include "nsgs/friction_problem.hpp"

namespace aussois {

struct SceneBody {
  double mass = 0;              // [kg]; 0: fixed
  Mat3 inertia = Mat3::Zero();  // about the centre of mass [kg m^2]
  Vec3 centre = Vec3::Zero();   // of mass [m]
  Vec6 twist = Vec6::Zero();    // (v_G, omega) at the begin of the step [m/s, rad/s]
  std::vector<std::vector<Vec3>>
      faces{};  // of a convex block, counter-clockwise from outside; of others none [m]
};

/// A block of rows between two bodies, or a joint.
struct Interaction {
  int a = 0, b = 0;           // the impulse acts on a, its opposite on b
  Vec3 point = Vec3::Zero();  // where it acts [m]
  std::vector<Vec6>
      rows{};      // directions (force, moment about the point) of the rows; normal first, from b to a
  Law law{};       // not of joints
  double gap = 0;  // >= 0; closed where 0 [m]
  double restitution = 0;  // Newton's, of a closed contact that approaches, in [0, 1]
};

struct FrictionScene {
  std::vector<SceneBody> bodies{};
  std::vector<Interaction> contacts{};  // blocks of H, in order
  std::vector<Interaction> joints{};    // columns of G
  Vec3 gravity{0, 0, -9.81};            // [m/s^2]; tilted where the ground shakes
  double h = 1e-3;                      // time step [s]
  double theta = 0;                     // of the gyroscopic moment: 0 explicit, M symmetric; 1 implicit
};

/// (FAM-1): the step of the free bodies, numbered in their order, six velocities each.
FrictionProblem friction_problem(const FrictionScene& scene);

// Bodies; they return their index. Density 0 [kg/m^3]: fixed.
int add_prism(
    FrictionScene& scene, const std::vector<Vec2>& profile, const SE3& pose, double length,
    double density);  // convex counter-clockwise profile in x, y; along z from -length/2 to length/2
int add_box(FrictionScene& scene, const Vec3& size, const SE3& pose, double density);
int add_ball(FrictionScene& scene, double radius, const Vec3& centre, double density);
int add_disk(FrictionScene& scene, double radius, double height, const Vec3& centre,
             double density);  // axis z
/// A fixed slab whose upper face is z = 0 over [-half, half]^2.
int add_ground(FrictionScene& scene, double half);

// Contacts and joints. `normal` (unit) points from b to a.
Interaction contact(int a, int b, const Vec3& point, const Vec3& normal, const Law& law, double gap = 0);
Interaction hinge(int a, int b, const Vec3& point, const Vec3& axis);  // 5 bilateral rows
Interaction about_axis(int a, int b, const Vec3& axis,
                       const Law& law);  // 1 row: a turns against b, limits, friction
/// Every two blocks, one of them free, with faces that look at each other across at most `slack` [m]: a
/// contact at every corner of the polygon that they share, at half the gap.
void touch_faces(FrictionScene& scene, double slack, const Law& law);

}  // namespace aussois
