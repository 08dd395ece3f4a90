// SPDX-License-Identifier: Apache-2.0
// Finds the point of a convex hull nearest to the origin (Wolfe; Gilbert, Johnson, Keerthi). Its norm tells
// how far a set of directions is from lying in no open half-space.
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

inline constexpr double kHullContainsOrigin = 1e-8;  // a hull of unit vectors this close to the origin
                                                     // contains it, to rounding

struct MinNorm {
  Vec3 point = Vec3::Zero();
  std::vector<int> support{};  // points with a convex weight above rounding, at most four
};

/// The point of conv{g} nearest to the origin; g must not be empty. Support points are added until none
/// improves the result or the hull contains the origin.
MinNorm min_norm_point(const std::vector<Vec3>& g);

}  // namespace aussois
