// SPDX-License-Identifier: Apache-2.0
// The contacts of one cluster, seen along their mean normal: their places in the plane, their hull, and how
// much of the hull a part of them spans (RED-3), (RED-7).
#pragma once

#include <span>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/contact_point.hpp"
#include "reduction/loss.hpp"

namespace aussois {

/// Members are numbered in the order in which they were given.
struct PlanarPatch {
  Mat3 frame = Mat3::Identity();  // columns n, u, v, world; n the mean normal, u the principal direction, or
                                  // an axis of body A if there is none (RED-3)
  Vec3 origin = Vec3::Zero();     // mean of the members, each at the middle of its proximal points [m]
  std::vector<Vec2> x{};          // coordinates of the members along u and v, from the origin [m]
  double extent = 0;              // the larger of the extents along u and v [m]
  std::vector<int> hull{};        // corners of the hull, counter-clockwise; each is the first member at its
                                  // place; no points on sides (within 1e-9 of the extent); two for a line,
                                  // one for a point
  double area = 0;                // of the hull [m^2]; 0 for a line or a point
  Vec2 centroid = Vec2::Zero();   // of the hull's area; for a line, its middle [m]
  double drilling_radius = 0;     // mean distance of the hull's area, or line, from the centroid [m] (RED-8)
};

/// There must be at least one member, and all must be of one body pair. `g` is as ReductionInput::g.
PlanarPatch planar_patch(const ContactSet& found, std::span<const int> members, std::span<const SE3> g = {});
/// The same for points that are already in their plane.
PlanarPatch planar_patch(std::vector<Vec2> x);

/// Corners of the hull of some members, as PlanarPatch::hull.
std::vector<int> hull_of(const PlanarPatch& patch, std::span<const int> members);

/// The margin of a part of the members and the direction in which it is reached (RED-7).
struct Margin {
  double value = 1;  // at most 1; -kInf without members
  Vec2 direction = Vec2::UnitX();
};
Margin margin_of(const PlanarPatch& patch, std::span<const int> part);

/// What is lost if only a part of the members is kept (RED-7), (RED-8), (RED-9); depth is left at 0.
LossReport loss_of(const PlanarPatch& patch, std::span<const int> part);

/// E(d, side) of (RED-3). Members within `tie` [m] of the farthest along `d` are tied; of these the farthest
/// along `side` is taken, and of those at one place the first.
int extreme_member(const PlanarPatch& patch, const Vec2& d, const Vec2& side, double tie);

inline constexpr double kSamePlace = 1e-9;  // fraction of the extent within which points count as one

}  // namespace aussois
