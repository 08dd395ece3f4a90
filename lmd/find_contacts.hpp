// SPDX-License-Identifier: Apache-2.0
// All quasi-local minima of the distance between two posed shapes, as a function of the pose alone (LMD-3),
// (LMD-10).
#pragma once

#include <utility>
#include <vector>

#include "lmd/contact_point.hpp"
#include "lmd/leaf.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

struct LmdOptions {
  double threshold = 1e-3;           // report contacts with gap <= threshold [m], >= 0
  double alpha = 2 * kPi / 180;      // small rotations forgiven by the quasi-LMD rule [rad], in [0, 0.5]
  double alpha_ee = 10 * kPi / 180;  // the same for the direction of edge against edge [rad], in [alpha, 1]
  int threads = 1;                   // the result does not depend on it
};
void validate(const LmdOptions& options);  // throws std::invalid_argument: field, value, bound

/// What a query looked at: pairs of nodes, of leaves in single precision, and of those in double precision.
struct LmdStatistics {
  long node_pairs = 0, leaf_pairs = 0, exact_tests = 0, minima = 0;  // minima: before merging
};

/// How far the two shapes may move against each other from the pose of a search.
struct MotionWindow {
  double displacement = 0;  // of any point of A seen from B [m], >= 0
  double rotation = 0;      // of A seen from B [rad], >= 0
};
void validate(const MotionWindow& window);

/// Pairs of leaves among which all contacts of all poses in a window are: one descent serves all iterates of
/// a step. Refers to the shapes.
struct Candidates {
  const LmdShape *a = nullptr, *b = nullptr;
  SE3 g_ba{};  // A's frame in B's at the search
  MotionWindow window{};
  LmdOptions options{};
  std::vector<std::pair<LeafId, LeafId>> pairs{};  // sorted
};

Candidates find_candidates(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                           const MotionWindow& window, LmdStatistics* statistics = nullptr);

/// The contacts at the poses of `a` and `b`: those of find_contacts there. Throws std::invalid_argument if
/// the poses are outside the window or the shapes are others.
ContactSet find_contacts(const Candidates& candidates, const PosedShape& a, const PosedShape& b);

/// The contacts of one pair, sorted as ContactSet says. Shapes whose base simplices touch have no defined
/// direction there: such pairs of simplices are left out (the certificate is what forbids them).
ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options = {},
                         LmdStatistics* statistics = nullptr);

/// The same by looking at every pair of leaves: the oracle.
ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options = {});

}  // namespace aussois
