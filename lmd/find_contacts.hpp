// SPDX-License-Identifier: Apache-2.0
// Finds all quasi-local minima of the distance between two posed shapes, as a function of the pose alone
// (LMD-3), (LMD-10).
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"
#include "lmd/lmd_options.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

/// The pairs of leaves among which all contacts of all poses in a window are found: one descent serves all
/// iterates of a step. Holds pointers to the shapes.
struct Candidates {
  const LmdShape *a = nullptr, *b = nullptr;
  SE3 g_ba{};  // A's frame in B's at the search
  MotionWindow window{};
  LmdOptions options{};
  std::vector<LeafPair> pairs{};  // sorted
  std::vector<Leaf> leaves_b{};   // those of B among them, each once
  std::vector<int> leaf_b{};      // of every pair, in `leaves_b`
};

Candidates find_candidates(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                           const MotionWindow& window, LmdStatistics* statistics = nullptr);

/// The contacts at the poses of `a` and `b`, the same as a full search finds there. Throws
/// std::invalid_argument if the poses are outside the window or the shapes are not those of the search.
ContactSet find_contacts(const Candidates& candidates, const PosedShape& a, const PosedShape& b);

/// The contacts of one pair, sorted as ContactSet says. Base simplices that touch define no direction; such
/// pairs of simplices are left out (the certificate forbids them).
ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options = {},
                         LmdStatistics* statistics = nullptr);

/// What a caller may keep of a pair from query to query; nothing for two balls, whose only pair of leaves is
/// known. It speeds up queries of slow motions and never changes what they find (LMD-12). Candidates are kept
/// if they are at most kMostCandidates for each leaf of both shapes, or few anyway.
struct PairScratch {
  bool asked = false;
  SE3 g_ba{};  // at the last query
  Candidates candidates{};
};
inline constexpr std::size_t kMostCandidates = 8;
/// The memory of its lists [bytes].
std::size_t bytes_of(const PairScratch& scratch);
ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         PairScratch& scratch);

/// The same by testing every pair of leaves: the oracle.
ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options = {});

}  // namespace aussois
