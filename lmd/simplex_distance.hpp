// SPDX-License-Identifier: Apache-2.0
// Finds the closest points of points, segments and triangles (LMD-11). Cases after Ericson 2005, ch. 5.
// Triangles include their interiors: the distance of two that cross is 0.
#pragma once

#include <span>

#include "geometry/types.hpp"

namespace aussois {

struct ClosestPoints {
  Vec3 x_a = Vec3::Zero(), x_b = Vec3::Zero();  // [m]
  double distance = kInf;                       // [m]
};

/// The closest points of two simplices, given by one to three vertices each.
ClosestPoints closest_points(std::span<const Vec3> a, std::span<const Vec3> b);

/// True if two simplices are certainly farther apart than `distance`, because a plane separates them by more:
/// the plane of one of them, or one perpendicular to the line between their means. Correct to rounding, and
/// faster than closest_points. False says nothing.
bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, double distance);

}  // namespace aussois
