// SPDX-License-Identifier: Apache-2.0
// A second opinion on the certificate: the distance of every two base complexes at many places of a step's
// path, each looked at by itself. Slow, and no proof; the certificate has to stay below what it finds (CA-9).
#pragma once

#include <cstdint>

#include "integrators/advancement.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct PathAudit {
  int samples = 0;  // per step, its end included, and of every piece one at least; 0: nothing is looked at
  double max_overlap = AdvancementOptions{}.max_overlap;  // of the scheme's advancement [-]
  double min_distance = kInf;   // of the base complexes, of all samples so far [m]; infinity: nothing near
  double min_slack = kInf;      // by which samples lie above what is certified of their pair, at least [m]
  std::int64_t steps = 0;       // looked at
  std::int64_t violations = 0;  // of them with a sample below what is certified of its pair
};

/// Looks at the path of an accepted step that began at `start`. Distances of a pair above twice the sum of
/// its dilations are not looked at; nor is a model in which no two bodies have shapes. Throws
/// std::invalid_argument if the report has no path (event_driven without its certificate).
void audit_path(const Model& model, const State& start, const StepReport& report, int threads,
                PathAudit& audit);

}  // namespace aussois
