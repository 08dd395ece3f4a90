// SPDX-License-Identifier: Apache-2.0
// Accelerated sweeps while they contract well for what they cost, Newton when they do not, sweeps again where
// Newton fails (AUTO-1) to (AUTO-4).
#include <algorithm>
#include <cmath>

#include "nsgs/fixed_point.hpp"
#include "nsgs/proximal_newton.hpp"

namespace aussois {

namespace {

constexpr int kMemory = 5;                // steps that Anderson acceleration combines
constexpr int kFirstWindow = 5;           // sweeps until their contraction is judged
constexpr double kAim = 1e-8;             // residual that sweeps are taken to aim at
constexpr double kLeastAhead = 100;       // by which they are taken to have to fall, at least
constexpr double kNewtonIterations = 30;  // about, of a second phase
constexpr double kLeastCost = 2;          // of a Newton iteration in sweeps, about; counted only above
constexpr double kLongestWait = 300;      // sweeps before Newton may take over, at most
constexpr int kAttempts = 8;              // after these sweeps go on alone,
constexpr int kInVain = 2;                // or after so many in a row that gain nothing above kAim,
constexpr double kGain = 0.99;            // which is less than this of the residual
constexpr double kSettlingCost = 100;     // sweeps, of the steps of a settling phase, about
constexpr double kWarm = 1e-3;            // residual of a start whose contacts are settled but for a few
constexpr double kCheap = 50;             // sweeps, of a Newton iteration
constexpr double kGiving = 100;  // compliance of its first step over its residual: 10 was too little for most
                                 // steps of balls that roll
constexpr double kMoving = 10;   // tolerances, of a warm start: the next one will not be within either

// A warm start usually has the right cases already, and then Newton ends in one or two solves where sweeps
// would creep (AUTO-4). It goes on to a thousandth of the tolerance, so that the next steps start within;
// where that is in vain, to a tenth.
Iterate warmed(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  if (start.residual > kWarm || start.r.isZero(0) || W.newton_cost(start.r) > kCheap) return start;
  const bool is_moving = start.residual > kMoving * options.tolerance;
  return proximal_steps(W, start,
                        {.tolerance = options.tolerance / (is_moving ? 10 : 1e3),
                         .max_steps = 3,
                         .max_iterations = 6,
                         .alpha = std::clamp(kGiving * start.residual, 1e-6, 1e-2),
                         .accuracy = 1e-7},
                        report);
}

// The second phase; after a failure, again from elsewhere and in another way (AUTO-3).
Iterate second_phase(Delassus& W, const Iterate& start, int attempt, const SolverOptions& options,
                     SolveReport& report) {
  ProximalOptions way{.tolerance = options.tolerance, .max_iterations = 100};
  if (attempt == 0) return proximal_steps(W, start, way, report);
  Iterate from = start;
  if (attempt == 1) {
    SolveReport inner;
    from = interior_point(W, start, {.tolerance = options.tolerance, .max_iterations = 100}, inner);
    report.newton_iterations += inner.iterations;
  }
  constexpr double kAlphas[]{1e-3, 1, 1e-2, 0.1};
  way.alpha = kAlphas[(attempt - 1) % 4];
  way.accuracy = attempt % 2 == 1 ? 1e-9 : 1e-4;
  way.max_iterations = 100 << attempt;
  way.max_steps = 60 << attempt;
  return proximal_steps(W, from, way, report);
}

// Sweeps that are left at the rate of the last ones, whatever the tolerance (AUTO-1).
double sweeps_left(double before, double now, int sweeps) {
  if (!(now < before)) return kInf;
  return sweeps * std::log(std::max(now / kAim, kLeastAhead)) / std::log(before / now);
}

}  // namespace

Iterate automatic(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  Iterate begin = warmed(W, start, options, report);
  if (begin.residual <= options.tolerance) return begin;
  const SweepOptions sweep{.local = options.local, .relaxation = options.relaxation};
  SweepCounts counts;
  FixedPoint sweeps(W, begin, Method::nsgs, kMemory, [&](VecX& r) { return W.sweep(r, sweep, counts); });
  double window_residual = sweeps.best().residual, newton = kInf;  // what a second phase costs, in sweeps
  int window = kFirstWindow, window_start = 0, phase_start = 0, weighed_at = 0, attempts = 0, in_vain = 0;
  bool settled_once = false;
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
    const double left = sweeps_left(window_residual, now.residual, window);
    window_start = report.iterations;
    window_residual = now.residual;
    if (left <= kLeastCost * kNewtonIterations || attempts == kAttempts || in_vain == kInVain) continue;
    const int swept = report.iterations - phase_start;
    if (swept >= 2 * weighed_at) {  // it takes a sweep or two itself
      weighed_at = swept;
      newton = kNewtonIterations * W.newton_cost(now.r);
    }
    if (!settled_once && left > newton / kNewtonIterations + kSettlingCost) {  // (AUTO-5)
      settled_once = true;
      sweeps.go_on_from(settled(W, now, options.tolerance));
      window_residual = sweeps.now().residual;
      continue;
    }
    if (left <= newton || swept < std::min(newton / 10, kLongestWait)) continue;  // (AUTO-2)
    const double best = sweeps.best().residual;
    sweeps.offer(second_phase(W, attempts == 0 ? now : sweeps.best(), attempts, options, report));
    ++attempts;
    in_vain = sweeps.best().residual < std::max(kGain * best, kAim) ? 0 : in_vain + 1;
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
