// SPDX-License-Identifier: Apache-2.0
// Descends the trees of two shapes for the minima of one pose, or for the candidates of all poses in a window
// (LMD-9), (LMD-12).
#pragma once

#include "lmd/lmd_options.hpp"
#include "lmd/material_neighbours.hpp"
#include "lmd/minimum_test.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

/// A pair of shapes as the tests see it: A's frame mapped to B's.
struct RelativePair {
  const LmdShape *a = nullptr, *b = nullptr;
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();  // [m]
  MinimumCriteria criteria{};
  const MaterialNeighbours* self = nullptr;  // of a shape that meets itself
};
RelativePair relative_pair(const PosedShape& a, const PosedShape& b, const LmdOptions& options);

/// Kernels accept feet that are off by a length, nodes prune by angles: at a distance d the length is worth
/// tau / d [rad].
double angle_slack(const RelativePair& pair);

/// Whether two leaves are looked at: all are, but for those of one shape that are neighbours in the material.
bool may_meet(const RelativePair& pair, LeafId a, LeafId b);

struct FoundMinimum {
  LeafId a{}, b{};
  LocalMinimum minimum{};
};

struct SearchResult {
  std::vector<FoundMinimum> found{};
  std::vector<LeafPair> candidates{};  // instead of `found`, if there is a window
  LmdStatistics count{};
};

/// Tests every pair of leaves.
SearchResult search_exhaustively(const RelativePair& pair);

/// Searches in an order that depends on the shapes alone. Minima may be found twice.
SearchResult search_pair(const RelativePair& pair, const MotionWindow* window, const LmdOptions& options);

}  // namespace aussois
