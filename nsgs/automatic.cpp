// SPDX-License-Identifier: Apache-2.0
// Accelerated sweeps while they contract well for what they cost, Newton when they do not, sweeps again where
// Newton fails (AUTO-1) to (AUTO-3).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "nsgs/fixed_point.hpp"
#include "nsgs/proximal_newton.hpp"

namespace aussois {

namespace {

constexpr int kMemory = 5;                // steps that Anderson acceleration combines
constexpr int kFirstWindow = 5;           // sweeps until their contraction is judged
constexpr double kNewtonIterations = 30;  // about, of a second phase
constexpr double kLongestWait = 300;      // sweeps before Newton may take over, at most
// Where Newton fails it is asked again later, from elsewhere and another way, in turn.
constexpr ProximalOptions kWays[]{{.alpha = 0.1, .accuracy = 1e-2},
                                  {.alpha = 1e-3, .accuracy = 1e-9},
                                  {.alpha = 1, .accuracy = 1e-9},
                                  {.alpha = 1e-2, .accuracy = 1e-4}};

// Sweeps until the tolerance, at the rate of the last ones (AUTO-1).
double sweeps_left(double before, double now, int sweeps, double tolerance) {
  if (now <= tolerance) return 0;
  if (!(now < before)) return kInf;
  return sweeps * std::log(now / tolerance) / std::log(before / now);
}

}  // namespace

Iterate automatic(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const SweepOptions sweep{.local = options.local, .relaxation = options.relaxation};
  SweepCounts counts;
  FixedPoint sweeps(W, start, Method::nsgs, kMemory, [&](VecX& r) { return W.sweep(r, sweep, counts); });
  double window_residual = start.residual, newton = kInf;  // what a second phase costs, in sweeps
  int window = kFirstWindow, window_start = 0, phase_start = 0, weighed_at = 0, attempts = 0;
  report.status = SolveStatus::max_iterations;
  while (sweeps.best().residual > options.tolerance && report.iterations < options.max_iterations) {
    ++report.iterations;
    sweeps.advance(options.tolerance, true);
    if (!sweeps.finite() || sweeps.stagnated()) {
      report.status = sweeps.finite() ? SolveStatus::stagnated : SolveStatus::not_finite;
      break;
    }
    if (report.iterations - window_start < window) continue;
    const Iterate& now = sweeps.now();
    const double left = sweeps_left(window_residual, now.residual, window, options.tolerance);
    window_start = report.iterations;
    window_residual = now.residual;
    const int swept = report.iterations - phase_start;
    if (swept >= 2 * weighed_at) {  // it takes a sweep or two itself
      weighed_at = swept;
      newton = kNewtonIterations * W.newton_cost(now.r);
    }
    if (left <= newton || swept < std::min(newton / 10, kLongestWait)) continue;  // (AUTO-2)
    ProximalOptions way = kWays[std::size_t(attempts++) % std::size(kWays)];
    way.tolerance = options.tolerance;
    sweeps.offer(proximal_steps(W, now, way, report));
    sweeps.resume();  // where Newton fails, the sweeps go on from where they were, with more room
    window *= 2;
    phase_start = report.iterations;
    weighed_at = 0;
  }
  if (sweeps.best().residual <= options.tolerance) report.status = SolveStatus::converged;
  report.local_failures += counts.failures;
  report.local_fail_safes += counts.fail_safes;
  return sweeps.best();
}

}  // namespace aussois
