// SPDX-License-Identifier: Apache-2.0
// Splits a vertex whose planes do not meet in one point (ERO-3), (ERO-4).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lmd/mitre.hpp"

namespace aussois {

struct MeetingPoint {
  Vec3 x = Vec3::Zero();
  double residual = kInf;  // largest distance from a plane
};

/// The shortest of the points that all planes pass within `tolerance`; if there is none, the one of full rank
/// (ERO-2). Directions that the planes hardly determine are used only if needed.
MeetingPoint meeting_point(std::span<const VertexPlane> planes, double tolerance);

/// A triangle of the polygon of planes and the point where its three planes meet.
struct SplitPoint {
  std::array<int, 3> planes{};  // ascending
  Vec3 x = Vec3::Zero();
};

/// Of all ways to cut the polygon of at least four planes into triangles, the one with the largest solid
/// whose planes all have a simple border; nullopt if there is none, or if the search is given up. Three
/// planes that meet farther away than `longest` are treated as parallel to a line. O(d^4).
std::optional<std::vector<SplitPoint>> largest_split(std::span<const VertexPlane> planes, double meet,
                                                     double longest);

}  // namespace aussois
