// SPDX-License-Identifier: Apache-2.0
// What contact determination finds: local minima of the distance between two dilated complexes (LMD-3).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "geometry/types.hpp"
#include "lmd/body_id.hpp"

namespace aussois {

/// The open simplex that carries a proximal point.
struct Feature {
  BodyId body{};    // index of the posed shape
  int dim = 0;      // 0 vertex, 1 edge, 2 face
  int simplex = 0;  // index among the simplices of that dimension
  int region = 0;   // what the simplex belongs to after idealisation: the vertex itself, the straight
                    // chain of an edge, the planar region of a face; does not depend on the triangulation
  std::array<double, 3> bary{};  // barycentric coordinates of the proximal point on the simplex
};

/// Identifies a contact from step to step (PER-1): both bodies, and (dim, region) of both sides in one word,
/// A's in the upper half. Keys are ordered by (body_a, body_b, dim and region of A, dim and region of B).
struct ContactKey {
  BodyId body_a{}, body_b{};
  std::uint64_t feature = 0;
  auto operator<=>(const ContactKey&) const = default;
};

/// Half a feature word: two bits of dim, thirty of region.
struct KeyFeature {
  int dim = 0, region = 0;
  bool operator==(const KeyFeature&) const = default;
};
std::uint64_t feature_word(const KeyFeature& a, const KeyFeature& b);  // dim in [0, 3], region in [0, 2^30)
KeyFeature feature_a(const ContactKey& key);
KeyFeature feature_b(const ContactKey& key);

struct ContactPoint {
  Feature a{}, b{};
  Vec3 x_a = Vec3::Zero();      // proximal point on the dilated surface of A, world [m]
  Vec3 x_b = Vec3::Zero();      // the same on B
  Vec3 normal = Vec3::UnitZ();  // unit, world, points from B to A
  double gap = 0;               // normal . (x_a - x_b) [m]; negative where the dilated shapes overlap
  double angle_margin = 0;      // how far the normal is inside the enlarged cones [rad], >= 0
};

ContactKey key_of(const ContactPoint& contact);

/// Midway between the proximal points: where the contact acts, world [m].
inline Vec3 mid_point(const ContactPoint& contact) {
  return 0.5 * (contact.x_a + contact.x_b);
}

/// Sorted by (a.body, b.body, a.dim, a.simplex, b.dim, b.simplex): the order is part of the result.
struct ContactSet {
  std::vector<ContactPoint> points{};
};

/// Smallest gap of the set [m]; kInf if it is empty.
double smallest_gap(const ContactSet& contacts);

}  // namespace aussois
