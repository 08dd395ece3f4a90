// SPDX-License-Identifier: Apache-2.0
// Tangent cones C and their negative polars N = { n : n . t <= 0 for all t in C }, the normal cones (LMD-1),
// (LMD-2). C = Lin + P: the lineality space and a pointed part in Lin's complement given by its extreme unit
// rays.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// A cone as the tests of a query see it, wherever it is stored.
struct ConeView {
  std::span<const Vec3> lin{};   // orthonormal; spans Lin
  std::span<const Vec3> rays{};  // extreme rays of the pointed part, unit; in 3D in cyclic order
  bool cyclic = true;            // false: wrapping failed on a degenerate star; all rays are kept, unordered
};

struct NormalCone {
  int lineality = 3;  // dimension of Lin, 0 to 3; 3: C is everything and N = {0}
  std::array<Vec3, 3> lin{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};  // the first `lineality` span Lin
  std::vector<Vec3> rays{};
  bool cyclic = true;
  Vec3 axis = Vec3::UnitZ();  // of a cap around N, unit
  double half_angle = 0;      // of that cap [rad]; pi: any direction
  // How far the hull of the unit directions is from the origin, where C is pointed; 0: it is not. The sine of
  // the angle by which all of them fall off from the best plane
  double depth = 0;
  operator ConeView() const { return {{lin.data(), std::size_t(lineality)}, rays, cyclic}; }
};

/// The canonical form of cone{ directions } and a cap around its polar. Directions need not be unit; zero
/// directions are ignored. Without any direction C = {0} and N is everything.
NormalCone make_normal_cone(const std::vector<Vec3>& directions);

/// The same for an edge along the unit vector e and the unit conormals of its triangles, perpendicular to e.
NormalCone edge_cone(const Vec3& e, std::span<const Vec3> conormals);

/// Quick necessary test for angle_to(cone, u) <= alpha: the mitred enlargement of N (LMD-6).
bool may_contain(const ConeView& cone, const Vec3& u, double sin_alpha);

/// Angle between the unit vector u and N in [0, pi/2] [rad]; pi/2 if the projection is zero, kInf if N = {0}.
/// 0 inside.
double angle_to(const ConeView& cone, const Vec3& u);

/// Ends of the arc of an edge's normal cone (lineality 1): two for a crease or a border, none for a wire.
struct ArcEnds {
  std::array<Vec3, 2> ends{};
  std::size_t count = 0;
  std::span<const Vec3> span() const { return {ends.data(), count}; }
};
ArcEnds arc_ends(const ConeView& cone);

}  // namespace aussois
