// SPDX-License-Identifier: Apache-2.0
// Nonsmooth Gauss-Seidel (NSGS-4) to (NSGS-7): one block after the other, each solved exactly. Source: Jean
// and Moreau 1992; Acary and Brogliato 2008, ch. 13.
#include <cmath>

#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 1000;  // sweeps without halving the best residual

}  // namespace

Iterate nsgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  Iterate best = start, swept = start;
  JudgeSchedule schedule;
  SweepCounts counts;
  double halved = best.residual;
  int halved_at = 0;
  W.velocity(swept.r);
  report.status = SolveStatus::max_iterations;
  while (best.residual > options.tolerance && report.iterations < options.max_iterations) {
    const double change =
        W.sweep(swept.r, {.local = options.local, .relaxation = options.relaxation}, counts);
    ++report.iterations;
    if (!schedule.due(report.iterations, change, options.tolerance) &&
        report.iterations < options.max_iterations)
      continue;
    swept = judged(W, std::move(swept.r), Method::nsgs);
    if (swept.residual == kInf) {
      report.status = SolveStatus::not_finite;
      break;
    }
    if (swept.residual < best.residual) best = swept;
    if (best.residual <= halved / 2) halved = best.residual, halved_at = report.iterations;
    if (report.iterations - halved_at >= kPatience) {
      report.status = SolveStatus::stagnated;
      break;
    }
  }
  if (best.residual <= options.tolerance) report.status = SolveStatus::converged;
  report.local_failures += counts.failures;
  report.local_fail_safes += counts.fail_safes;
  return best;
}

}  // namespace aussois
