// SPDX-License-Identifier: Apache-2.0
// An essential open simplex as the tests of a query see it, assembled from the tables of its shape.
#pragma once

#include <compare>
#include <vector>

#include "lmd/lmd_shape.hpp"
#include "lmd/normal_cone.hpp"

namespace aussois {

/// Identifies a leaf: a corner, a chain, or one side of a triangle.
struct LeafId {
  std::int32_t index = 0;  // in LmdShape::vertices, edges or faces
  std::int8_t dim = 0;
  std::int8_t side = 1;  // faces of sheets: +1 or -1
  auto operator<=>(const LeafId&) const = default;
};

struct Leaf {
  int dim = 0;
  Vec3 x[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // the corners [m]; chains: the two ends
  Vec3 direction = Vec3::UnitZ();  // chains: unit, from x[0] to x[1]; faces: normal of the region, this side
  double extent = 0;  // chains: length [m]; faces: offset of the region's plane along `direction` [m]
  double turn = 1;    // faces: +1 if the corners run counter-clockwise seen along -direction
  double misfit = 0;  // chains: how far a foot may lie beyond the ends, per distance (LMD-15)
  std::array<Vec3, 2> conormals{};  // chains: unit, into the triangles
  std::size_t conormal_count = 0;
  std::span<const Vec3> rays{};  // corners: rays of the tangent cone
  bool cyclic = true;
};

Leaf leaf_of(const LmdShape& shape, LeafId id);
/// The vertices of a leaf of a shape that deforms, where chains are edges.
std::vector<int> corners_of(const LmdShape& shape, LeafId id);

/// The cone of a leaf that is not a face. Valid as long as the leaf lives.
inline ConeView cone_of(const Leaf& leaf) {
  if (leaf.dim == 0) return {{}, leaf.rays, leaf.cyclic};
  return {{&leaf.direction, 1}, {leaf.conormals.data(), leaf.conormal_count}, true};
}

/// True for V x {V, E, F}, E x {V, E}, F x {V}: no other pair is ever a strict minimum (LMD-7).
constexpr bool can_touch(int dim_a, int dim_b) {
  return dim_a + dim_b <= 2;
}

}  // namespace aussois
