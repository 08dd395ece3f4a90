// SPDX-License-Identifier: Apache-2.0
// Computes the convex hull of points by exact orientation tests: quickhull [Barber1996] without a tolerance.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Triangles of the hull, counter-clockwise seen from outside; corners are indices into `points`. Points
/// inside the hull, and points on it that lie between others, may be absent. Throws std::invalid_argument if
/// a coordinate is not finite or if all points lie in one plane.
std::vector<std::array<int, 3>> convex_hull(std::span<const Vec3> points);

}  // namespace aussois
