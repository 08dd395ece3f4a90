// SPDX-License-Identifier: Apache-2.0
// Finds which of many bodies can be near each other (CA-11), (CA-12): pairs of dilated oriented boxes that
// meet, by descending a tree of axis-aligned boxes against itself. O(n log n + pairs) for bodies of all
// sizes; decision record 0009.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

/// All points within `radius` of an oriented box: where a body is, or can be during a step.
struct DilatedBox {
  Vec3 centre = Vec3::Zero();    // [m], finite
  Mat3 axes = Mat3::Identity();  // columns, orthonormal
  Vec3 half = Vec3::Zero();      // half widths along the axes [m], >= 0; zero: a ball
  double radius = 0;             // dilation and everything that inflates it [m], >= 0
  bool fixed = false;            // two fixed boxes never form a pair
};

/// A box along the axes of the world.
struct StraightBox {
  Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);  // [m]; empty by default
  void add(const Vec3& a, const Vec3& b) { lo = lo.cwiseMin(a), hi = hi.cwiseMax(b); }
  double width() const { return (hi - lo).maxCoeff(); }
  bool meets(const StraightBox& b) const {
    return (lo.array() <= b.hi.array()).all() && (b.lo.array() <= hi.array()).all();
  }
  bool holds(const StraightBox& b) const {
    return (lo.array() <= b.lo.array()).all() && (b.hi.array() <= hi.array()).all();
  }
  StraightBox enlarged(double by) const { return {lo - Vec3::Constant(by), hi + Vec3::Constant(by)}; }
  /// Largest distance between corresponding sides of two boxes [m].
  double farthest_side(const StraightBox& b) const {
    return std::max((lo - b.lo).lpNorm<Eigen::Infinity>(), (hi - b.hi).lpNorm<Eigen::Infinity>());
  }
};

/// A small box around the points, along the coordinate axes or the principal axes, whichever gives the
/// smaller surface.
DilatedBox box_around(std::span<const Vec3> points);
DilatedBox operator*(const SE3& g, const DilatedBox& box);

/// Lower bound of the distance (CA-11) [m], exact for balls; negative where the bound says nothing.
double separation(const DilatedBox& a, const DilatedBox& b);

/// What a broad phase looked at.
struct BroadPhaseStatistics {
  long node_pairs = 0, box_pairs = 0;
};

/// Index pairs (i < j) whose separation is not positive, sorted. Touching counts; rounding errs towards
/// a pair. The result does not depend on `threads`.
std::vector<std::pair<int, int>> broad_phase(const std::vector<DilatedBox>& boxes, int threads = 1,
                                             BroadPhaseStatistics* statistics = nullptr);

/// What a caller may keep of its boxes from query to query (CA-18): which boxes can meet while all stay in
/// their rooms. It speeds up queries of slow motions and never changes what they find.
struct BroadPhaseScratch {
  std::vector<StraightBox> last{};                // around the boxes of the last query
  std::vector<StraightBox> room{};                // where each box may go
  std::vector<char> fixed{};                      // as it was when the rooms were made
  std::vector<std::pair<int, int>> neighbours{};  // pairs whose rooms meet, sorted
};
std::vector<std::pair<int, int>> broad_phase(const std::vector<DilatedBox>& boxes, int threads,
                                             BroadPhaseScratch& scratch);
/// The memory of its lists [bytes].
std::size_t bytes_of(const BroadPhaseScratch& scratch);

}  // namespace aussois
