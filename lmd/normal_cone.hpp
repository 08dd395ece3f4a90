// SPDX-License-Identifier: Apache-2.0
// Tangent cones C and their negative polars N = { n : n . t <= 0 for all t in C }, the normal cones (LMD-1),
// (LMD-2). C = Lin + P: the lineality space and a pointed part in Lin's complement given by its extreme unit
// rays.
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct NormalCone {
  int lineality = 3;            // dimension of Lin, 0 to 3; 3: C is everything and N = {0}
  Mat3 lin = Mat3::Identity();  // orthonormal; its first `lineality` columns span Lin
  std::vector<Vec3> rays{};  // extreme rays of the pointed part, unit; in 3D in cyclic order
  bool cyclic = true;  // false: wrapping failed on a degenerate star, all rays are kept, in no order
  Vec3 axis = Vec3::UnitZ();  // of a cap around N, unit
  double half_angle = 0;      // of that cap [rad]; pi: any direction
};

/// The canonical form of cone{ directions } and a cap around its polar. Directions need not be unit; zero
/// ones are left out. No direction at all: C = {0}, N is everything.
NormalCone make_normal_cone(const std::vector<Vec3>& directions);

/// Cone of a face with outward unit normal n: C the half-space below, N the ray n.
NormalCone face_cone(const Vec3& n);

/// Quick and necessary test of angle_to(cone, u) <= alpha: the mitred enlargement of N (LMD-6).
bool may_contain(const NormalCone& cone, const Vec3& u, double sin_alpha);

/// Angle between the unit vector u and N in [0, pi/2] [rad]; pi/2 if the projection is zero, kInf if N = {0}.
/// 0 inside.
double angle_to(const NormalCone& cone, const Vec3& u);

/// Ends of the arc of an edge's normal cone (lineality 1): two for a crease or a border, none for a wire.
std::vector<Vec3> arc_ends(const NormalCone& cone);

}  // namespace aussois
