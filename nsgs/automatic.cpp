// SPDX-License-Identifier: Apache-2.0
// Sweeps while they contract well, Newton when they do not, sweeps again where Newton fails (AUTO-1) to
// (AUTO-3).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "nsgs/proximal_newton.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 1000;       // sweeps without halving the best residual
constexpr int kFirstWindow = 5;       // sweeps until their contraction is judged
// Where Newton fails it is asked again later, from elsewhere and another way, in turn.
constexpr ProximalOptions kWays[]{{.alpha = 0.1, .accuracy = 1e-2},
                                  {.alpha = 1e-3, .accuracy = 1e-9},
                                  {.alpha = 1, .accuracy = 1e-9},
                                  {.alpha = 1e-2, .accuracy = 1e-4}};
constexpr double kLongestWait = 300;  // sweeps before Newton may take over, at most
constexpr double kNewtonIterations = 30;  // about, of a second phase

// Sweeps until the tolerance, at the rate of the last ones.
double sweeps_left(double before, double now, int sweeps, double tolerance) {
  if (now <= tolerance) return 0;
  if (!(now < before)) return kInf;
  return sweeps * std::log(now / tolerance) / std::log(before / now);
}

}  // namespace

Iterate automatic(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  Iterate best = start, swept = start;
  SweepCounts counts;
  JudgeSchedule schedule;
  double halved = best.residual, window_residual = best.residual;
  int halved_at = 0, window = kFirstWindow, window_start = 0, start_of_sweeps = 0, attempts = 0,
      weighed_at = 0;
  double newton = kInf;  // cost of a second phase in sweeps
  W.velocity(swept.r);
  report.status = SolveStatus::max_iterations;
  while (best.residual > options.tolerance && report.iterations < options.max_iterations) {
    const double change =
        W.sweep(swept.r, {.local = options.local, .relaxation = options.relaxation}, counts);
    ++report.iterations;
    const bool at_window = report.iterations - window_start >= window;
    if (!schedule.due(report.iterations, change, options.tolerance) && !at_window &&
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
    if (!at_window) continue;
    const double left = sweeps_left(window_residual, swept.residual, window, options.tolerance);
    if (report.iterations - start_of_sweeps >= 2 * weighed_at) {  // it takes a sweep or two itself
      weighed_at = report.iterations - start_of_sweeps;
      newton = kNewtonIterations * W.newton_cost(swept.r);
    }
    if (left > newton && report.iterations - start_of_sweeps >= std::min(newton / 10, kLongestWait)) {
      ProximalOptions way = kWays[std::size_t(attempts++) % std::size(kWays)];
      way.tolerance = options.tolerance;
      Iterate found = proximal_steps(W, swept, way, report);
      if (found.residual < best.residual) best = std::move(found);
      W.velocity(swept.r);  // where Newton fails, the sweeps go on from where they were, with more room
      window *= 2;
      start_of_sweeps = report.iterations;
      weighed_at = 0;
    }
    window_start = report.iterations;
    window_residual = swept.residual;
  }
  if (best.residual <= options.tolerance) report.status = SolveStatus::converged;
  report.local_failures += counts.failures;
  report.local_fail_safes += counts.fail_safes;
  return best;
}

}  // namespace aussois
