// SPDX-License-Identifier: Apache-2.0
// What --certify N found, and of whom no certificate speaks, for people and for summaries.
#pragma once

#include "integrators/prove/path_audit.hpp"
#include "io/checkpoint.hpp"
#include "io/summary.hpp"

namespace aussois {

/// certify_samples, certify_steps, certify_violations, certify_nested, certify_uncovered,
/// certify_min_distance [m; null: no two bodies came near] and certify_skipped, the names of the pairs that
/// nobody looks at; nothing if nothing was asked.
void set_audit(Summary& summary, const PathAudit& audit, const Model& model);

/// Prints one line if samples were asked for, and one on the pairs that are skipped. True: no violation.
bool tell(const PathAudit& audit, const Model& model);

/// In the names of a checkpoint: what was found, not how many samples were asked for.
void keep(const PathAudit& audit, Checkpoint& checkpoint);
PathAudit path_audit_of(const Checkpoint& checkpoint);

/// Of whom the certificates of a run do not speak.
struct Uncertified {
  std::int64_t passing_pairs = 0;    // most in a step (StepReport::passing_pairs)
  std::int64_t driven_overlaps = 0;  // steps with one (StepReport::driven_overlaps)
  double driven_t = kInf;            // start of the first of them [s]
};
void add(Uncertified& run, const StepReport& report);
/// passing_pairs, driven_overlaps, driven_overlap_t [s; null: none].
void set_uncertified(Summary& summary, const Uncertified& run);
/// Prints a line if moved and fixed bodies overlapped.
void tell(const Uncertified& run);

/// In the names of a checkpoint.
void keep(const Uncertified& run, Checkpoint& checkpoint);
Uncertified uncertified_of(const Checkpoint& checkpoint);

}  // namespace aussois
