// SPDX-License-Identifier: Apache-2.0
// Triangulates plane polygons with holes; exact arithmetic on the given doubles decides orientations. Also
// holds small helpers for computing in the plane.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// a x b: positive if b lies to the left of a.
inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The point of the segment from a to b nearest to x.
Vec2 nearest_on_segment(const Vec2& a, const Vec2& b, const Vec2& x);

/// Twice the signed area of a loop of points, positive if it runs counter-clockwise.
double twice_area(const std::vector<Vec2>& points, const std::vector<int>& loop);

/// Counter-clockwise triangles between `loops` of indices into `points`. The first loop is the outer one and
/// runs counter-clockwise; the others are holes and run clockwise. All given points are used and none is
/// added. Inner edges are Delaunay where the borders allow it, so points along a straight border make no flat
/// triangles. nullopt if the loops cross themselves or each other in a way that leaves no ear to cut; loops
/// that do not cross always have a triangulation. O(n^2).
std::optional<std::vector<std::array<int, 3>>> triangulate(const std::vector<Vec2>& points,
                                                           const std::vector<std::vector<int>>& loops);

}  // namespace aussois
