// SPDX-License-Identifier: Apache-2.0
#include "examples/common/match_report.hpp"

namespace aussois {

void add_matches(MatchTotals& totals, const MatchCounts& counts) {
  totals["matched_by_key"] += counts.by_key;
  totals["matched_by_adjacency"] += counts.by_adjacency;
  totals["matched_by_geometry"] += counts.by_geometry;
  totals["unmatched"] += counts.unmatched;
  totals["inherited"] += counts.inherited;
}

void set_matches(Summary& summary, MatchTotals totals) {
  add_matches(totals, {});  // all of them, also without a step
  for (const auto& [name, count] : totals) summary.set(name, count);
  const std::int64_t matched =
      totals["matched_by_key"] + totals["matched_by_adjacency"] + totals["matched_by_geometry"];
  const std::int64_t all = matched + totals["unmatched"];
  summary.set("match_share", all > 0 ? double(matched) / double(all) : 0.0);
}

}  // namespace aussois
