// SPDX-License-Identifier: Apache-2.0
// The point of a convex hull that is nearest to the origin (Wolfe; Gilbert, Johnson, Keerthi): how far a set
// of directions is from leaving every open half-space.
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

inline constexpr double kHullContainsOrigin = 1e-8;  // a hull of unit vectors this close to the origin
                                                     // contains it, to rounding

struct MinNorm {
  Vec3 point = Vec3::Zero();
  std::vector<int> support{};  // points whose convex weight is above rounding, at most four
};

/// Of conv{g}, g not empty. Support points are added until none improves or the hull contains the origin.
MinNorm min_norm_point(const std::vector<Vec3>& g);

}  // namespace aussois
