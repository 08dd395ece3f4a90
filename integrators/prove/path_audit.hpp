// SPDX-License-Identifier: Apache-2.0
// Checks the certificate by samples. At many places of a step's path and where the step ends, each taken by
// itself, it measures the distance of every two base complexes and looks for a body inside another. At the
// start and at the end it also checks that the contacts are as near as the bodies. The audit is slow, and no
// proof; the certificate has to stay below what it finds (CA-9).
#pragma once

#include <cstdint>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct PathAudit {
  int samples = 0;  // per step, including the path's end, with at least one in every piece; 0: no audit
  double max_overlap = AdvancementOptions{}.max_overlap;  // as in the scheme's advancement [-]
  double floor = AdvancementOptions{}.floor;              // likewise [-]
  double min_distance = kInf;   // of the base complexes, over all samples so far [m]; infinity: none near
  double min_slack = kInf;      // least amount by which a sample lies above what is certified of its pair [m]
  std::int64_t steps = 0;       // number of steps audited
  std::int64_t violations = 0;  // steps with a sample below what is certified of its pair, with a body inside
                                // another, with an end that the path does not lead to, or uncovered
  std::int64_t nested = 0;      // steps with a body inside another (CA-19)
  std::int64_t uncovered = 0;   // steps that found another smallest gap at their start than the bodies'
                                // distances less their dilations, or with a pair of which a search at their
                                // end does so, beyond (LMD-14)
};

/// Audits the path of an accepted step from `start` to `end`, and the state `end` itself: every place must
/// satisfy (CA-9), and the way from the path's end to the state must be too short to pass through anything.
/// Pairs of moved and fixed bodies count as certified unless the report names them (CA-20). Distances of a
/// pair above twice the sum of its dilations are skipped, and so are skipped_pairs(model) and a model in
/// which no two bodies have shapes. Throws std::invalid_argument if the report has no path (event_driven
/// without its certificate).
void audit_path(const Model& model, const State& start, const State& end, const StepReport& report,
                int threads, PathAudit& audit);

/// Pairs of Model::passing in which both bodies have shapes: neither certificate nor audit looks at them.
/// Sorted.
std::vector<BodyPair> skipped_pairs(const Model& model);

/// Smallest distance of the base complexes of bodies that can touch [m], or `cutoff` if that is smaller.
double min_base_distance(const Model& model, const State& state, double cutoff, int threads);

}  // namespace aussois
