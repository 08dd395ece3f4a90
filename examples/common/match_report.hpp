// SPDX-License-Identifier: Apache-2.0
// How the contacts of a run were recognised from step to step, for summaries and checkpoints.
#pragma once

#include <map>
#include <string>

#include "io/summary.hpp"
#include "reduction/warm_start.hpp"

namespace aussois {

/// Of all steps, by the names of their keys in a summary: matched_by_key, matched_by_adjacency,
/// matched_by_geometry, unmatched (of the contacts found) and inherited (of those gone).
using MatchTotals = std::map<std::string, std::int64_t>;
void add_matches(MatchTotals& totals, const MatchCounts& counts);

/// The totals, and match_share: of the contacts found, those known from the step before [-]; 0 without
/// contacts.
void set_matches(Summary& summary, MatchTotals totals);

}  // namespace aussois
