// SPDX-License-Identifier: Apache-2.0
// The options of contact determination, and the counts it reports.
#pragma once

#include <utility>

#include "lmd/leaf.hpp"

namespace aussois {

class SettingVisitor;

/// Which quick tests a search uses; for measurements. The contacts do not depend on it.
struct SearchTests {
  bool cones = true;         // opposing caps of nodes
  bool directions = true;    // the direction between nodes against their caps
  bool boxes = true;         // separating axes of nodes
  bool quick = true;         // leaves in single precision
  bool instructions = true;  // instructions that not every machine has
};
void describe(SettingVisitor& visit, SearchTests& options);

/// `describe` gives the ranges.
struct LmdOptions {
  double threshold = 1e-3;           // report contacts with gap <= threshold [m]
  double alpha = 2 * kPi / 180;      // small rotations tolerated by the quasi-LMD rule [rad]
  double alpha_ee = 10 * kPi / 180;  // the same for the direction of edge against edge [rad], at least alpha
  int threads = 1;                   // the result does not depend on it
  SearchTests tests{};
};
void validate(const LmdOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, LmdOptions& options);

/// What a query tested: pairs of nodes, pairs of leaves in single precision, and of those, pairs in double
/// precision.
struct LmdStatistics {
  long node_pairs = 0, leaf_pairs = 0, exact_tests = 0, minima = 0;  // minima: before merging
};

/// How far the two shapes may move relative to each other from the pose of a search.
struct MotionWindow {
  double displacement = 0;  // of any point of A seen from B [m], >= 0
  double rotation = 0;      // of A seen from B [rad], >= 0
};
void validate(const MotionWindow& window);

using LeafPair = std::pair<LeafId, LeafId>;

}  // namespace aussois
