// SPDX-License-Identifier: Apache-2.0
// Samples that check the certificate: the distance of every two base complexes at many places of a step's
// path and where it ends, each looked at by itself, whether one is inside the other, and whether the contacts
// at the end are as near as the bodies. Slow, and no proof; the certificate has to stay below what it finds
// (CA-9).
#pragma once

#include <cstdint>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct PathAudit {
  int samples = 0;  // per step, the path's end included, and of every piece one at least; 0: nothing
  double max_overlap = AdvancementOptions{}.max_overlap;  // of the scheme's advancement [-]
  double min_distance = kInf;   // of the base complexes, of all samples so far [m]; infinity: nothing near
  double min_slack = kInf;      // by which samples lie above what is certified of their pair, at least [m]
  std::int64_t steps = 0;       // looked at
  std::int64_t violations = 0;  // of them with a sample below what is certified of its pair, with a body
                                // inside another, with an end that the path does not lead to, or uncovered
  std::int64_t nested = 0;      // of them with a body inside another (CA-19)
  std::int64_t uncovered = 0;   // of them with an end where the smallest gap of a pair is not its distance
                                // less the dilations, to (LMD-14)
};

/// Looks at the path of an accepted step from `start` to `end`, and at the state `end` itself: every place is
/// held to (CA-9), and the way from the path's end to the state is too short to pass through anything.
/// Pairs of moved and fixed bodies count as certified unless the report names them (CA-20). Distances of a
/// pair above twice the sum of its dilations are not looked at, nor are skipped_pairs(model) and a model in
/// which no two bodies have shapes. Throws std::invalid_argument if the report has no path (event_driven
/// without its certificate).
void audit_path(const Model& model, const State& start, const State& end, const StepReport& report,
                int threads, PathAudit& audit);

/// Pairs of Model::passing that both have shapes: neither certificate nor audit looks at them. Sorted.
std::vector<std::pair<int, int>> skipped_pairs(const Model& model);

/// Smallest distance of the base complexes of bodies that can touch [m], or `cutoff`.
double min_base_distance(const Model& model, const State& state, double cutoff, int threads);

}  // namespace aussois
