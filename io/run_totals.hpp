// SPDX-License-Identifier: Apache-2.0
// Totals of a run besides its gauges, for summaries and checkpoints: contacts recognised, energy gained, what
// the audit found, and what no certificate covers.
#pragma once

#include "integrators/prove/path_audit.hpp"
#include "integrators/run.hpp"
#include "io/checkpoint.hpp"
#include "io/gauges.hpp"
#include "io/summary.hpp"

namespace aussois {

/// Counts of the contacts of all steps.
struct MatchTotals {
  std::int64_t by_key = 0, by_adjacency = 0, by_geometry = 0, unmatched = 0;  // contacts that were found
  std::int64_t inherited = 0;  // contacts that are gone and left their impulse to a neighbour
};

/// What the certificates of a run do not cover.
struct UncertifiedPairs {
  std::int64_t passing_pairs = 0;    // most in one step (StepReport::passing_pairs)
  std::int64_t driven_overlaps = 0;  // number of steps with any (StepReport::driven_overlaps)
  double driven_t = kInf;            // start of the first of them [s]
};

struct RunTotals {
  MatchTotals matches{};
  EnergyGain gain{};
  PathAudit audit{};
  UncertifiedPairs uncertified{};
};

/// The totals of a run that begins at `start`; `samples`: PathAudit::samples.
RunTotals run_totals(const Model& model, const State& start, int samples);
void add_frame(const Frame& frame, int threads, RunTotals& totals);

/// Sets
/// - matched_by_key, matched_by_adjacency, matched_by_geometry, unmatched, inherited;
/// - match_share, the share of the contacts found that the step before knew [-], 0 without contacts;
/// - energy_gain, the largest of the run [J];
/// - passing_pairs, driven_overlaps, driven_overlap_t [s; null: none];
/// - with an audit certify_samples, certify_steps, certify_violations, certify_nested, certify_uncovered,
///   certify_min_distance [m; null: no two bodies came near];
/// - certify_skipped, the names of the pairs that neither certificate nor audit looks at.
void set_totals(const RunTotals& totals, const Model& model, Summary& summary);
/// Only what the audit adds; `skipped` are the names of the pairs that it leaves out.
void set_audit(const PathAudit& audit, const std::vector<std::string>& skipped, Summary& summary);
/// The names of pairs that neither certificate nor audit looks at: "lid and box".
std::vector<std::string> names_of_skipped(const Model& model);

/// Keeps the totals under names of a checkpoint: all but the number of samples asked for.
void keep_totals(const RunTotals& totals, Checkpoint& checkpoint);
RunTotals run_totals_of(const Checkpoint& checkpoint, int samples);

}  // namespace aussois
