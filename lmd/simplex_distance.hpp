// SPDX-License-Identifier: Apache-2.0
// Closest points of points, segments and triangles (LMD-11). Ericson 2005, ch. 5, for the cases; the interior
// of two crossing triangles counts: their distance is 0.
#pragma once

#include <span>

#include "geometry/types.hpp"

namespace aussois {

struct ClosestPoints {
  Vec3 x_a = Vec3::Zero(), x_b = Vec3::Zero();  // [m]
  double distance = kInf;                       // [m]
};

/// Of two simplices given by one to three vertices each.
ClosestPoints closest_points(std::span<const Vec3> a, std::span<const Vec3> b);

/// Are two simplices surely farther apart than `distance`, because the plane of one of them or the one across
/// the line between their means parts them by more? Right to rounding, and quicker than closest_points.
/// "No" says nothing.
bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, double distance);

}  // namespace aussois
