// SPDX-License-Identifier: Apache-2.0
// All quasi-local minima of the distance between two posed shapes, as a function of the pose alone (LMD-3),
// (LMD-10).
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"
#include "lmd/lmd_options.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

/// Pairs of leaves among which all contacts of all poses in a window are: one descent serves all iterates of
/// a step. Refers to the shapes.
struct Candidates {
  const LmdShape *a = nullptr, *b = nullptr;
  SE3 g_ba{};  // A's frame in B's at the search
  MotionWindow window{};
  LmdOptions options{};
  std::vector<LeafPair> pairs{};  // sorted
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

/// What a caller may keep of a pair from query to query; nothing for two balls, whose only pair of leaves is
/// known. It makes queries of slow motions quicker and never
/// changes what they find (LMD-12).
struct PairScratch {
  bool asked = false;
  SE3 g_ba{};  // at the last query
  Candidates candidates{};
};
ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         PairScratch& scratch);

/// The same by looking at every pair of leaves: the oracle.
ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options = {});

}  // namespace aussois
