// SPDX-License-Identifier: Apache-2.0
// Tests whether a pair of open simplices is a (quasi-)local minimum of distance (LMD-3), (LMD-6), (LMD-8).
// The four kernels VV, VE, VF, EE work on leaves; no other pair can ever be a strict minimum.
#pragma once

#include <optional>

#include "lmd/leaf.hpp"

namespace aussois {

/// Angles and lengths of one query on one pair of shapes.
struct MinimumCriteria {
  double max_distance = 0;  // of the base simplices [m]
  double alpha = 0;         // enlargement of a vertex's cone, and of edge against edge [rad]
  double alpha_ee = 0;      // how far the direction may leave the arcs of two edges [rad]
  double tolerance = 0;     // inclusive tolerance of foot and cone tests [m]
  double sin_alpha = 0, sin_alpha_ee = 0;
};

/// A local minimum in the frame of B.
struct LocalMinimum {
  Vec3 x_a = Vec3::Zero(), x_b = Vec3::Zero();  // feet on the base simplices [m]
  Vec3 direction = Vec3::UnitZ();               // unit, from x_a to x_b
  double distance = 0;                          // [m]
  double angle_margin = 0;                      // [rad]
};

/// `R`, `t` map points from A's frame to B's. nullopt if the pair is not a (quasi-)local minimum within the
/// distance, or if the simplices touch (their direction is then undefined).
std::optional<LocalMinimum> test_minimum(const Leaf& a, const Leaf& b, const Mat3& R, const Vec3& t,
                                         const MinimumCriteria& criteria);

}  // namespace aussois
