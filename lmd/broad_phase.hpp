// SPDX-License-Identifier: Apache-2.0
// Which of many bodies can be near each other (CA-11), (CA-12): pairs of dilated oriented boxes that meet,
// from a tree of axis-aligned boxes descended against itself. O(n log n + pairs) for bodies of all sizes;
// decision record 0009.
#pragma once

#include <utility>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

/// All points closer than `radius` to an oriented box: where a body is, or can be during a step.
struct DilatedBox {
  Vec3 centre = Vec3::Zero();    // [m], finite
  Mat3 axes = Mat3::Identity();  // columns, orthonormal
  Vec3 half = Vec3::Zero();      // half widths along the axes [m], >= 0; zero: a ball
  double radius = 0;             // dilation and everything that inflates it [m], >= 0
  bool fixed = false;            // two fixed ones are no pair
};

/// A small box around the points: along the coordinate axes or the principal axes, whichever has less
/// surface.
DilatedBox box_around(const std::vector<Vec3>& points);
DilatedBox operator*(const SE3& g, const DilatedBox& box);

/// Lower bound of the distance (CA-11) [m], exact for balls; negative where the bound says nothing.
double separation(const DilatedBox& a, const DilatedBox& b);

/// What a broad phase looked at.
struct BroadPhaseStatistics {
  long node_pairs = 0, box_pairs = 0;
};

/// Index pairs (i < j) whose separation is not positive, sorted. Touching counts, rounding rounds towards
/// a pair. The result does not depend on `threads`.
std::vector<std::pair<int, int>> broad_phase(const std::vector<DilatedBox>& boxes, int threads = 1,
                                             BroadPhaseStatistics* statistics = nullptr);

}  // namespace aussois
