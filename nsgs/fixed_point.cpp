// SPDX-License-Identifier: Apache-2.0
#include "nsgs/fixed_point.hpp"

#include <utility>

namespace aussois {

FixedPoint::FixedPoint(Delassus& W, const Iterate& start, Method by, int memory, Step step)
    : W_(W),
      now_(start),
      best_(start),
      r_(start.r),
      memory_(memory),
      anderson_(memory),
      step_(std::move(step)) {
  now_.by = by;
  resume();
}

// Where the last steps together point to, if the judge prefers it to where this one began (AA-3). Otherwise
// nothing, and W is left at that place.
std::optional<Iterate> FixedPoint::accelerated(const VecX& after) {
  const VecX proposed = anderson_.propose(now_.r, after);
  if (proposed.size() == 0) return std::nullopt;
  Iterate iterate = judged(W_, projected_impulses(proposed, W_.scaled.laws), now_.by);
  if (iterate.residual < now_.residual) return iterate;
  anderson_.forget();
  return std::nullopt;
}

void FixedPoint::go_on_from(Iterate other) {
  if (other.residual < now_.residual) {
    now_ = std::move(other);
    r_ = now_.r;
    anderson_.forget();
    offer(now_);
  }
  resume();
}

bool FixedPoint::advance(double tolerance, bool last) {
  const double change = step_(r_);
  ++steps_;
  if (memory_ > 0) {
    std::optional<Iterate> ahead = accelerated(r_);
    now_ = ahead ? *std::move(ahead) : judged(W_, r_, now_.by);
    r_ = now_.r;
  } else {
    if (!schedule_.due(steps_, change, tolerance) && !last) return false;
    now_ = judged(W_, r_, now_.by);
  }
  offer(now_);
  return true;
}

Iterate fixed_point(Delassus& W, const Iterate& start, Method by, const SolverOptions& options,
                    SolveReport& report, const Step& step) {
  FixedPoint loop(W, start, by, options.anderson, step);
  report.status = SolveStatus::max_iterations;
  while (loop.best().residual > options.tolerance && report.iterations < options.max_iterations) {
    ++report.iterations;
    if (!loop.advance(options.tolerance, report.iterations == options.max_iterations)) continue;
    if (!loop.finite() || loop.stagnated()) {
      report.status = loop.finite() ? SolveStatus::stagnated : SolveStatus::not_finite;
      break;
    }
  }
  if (loop.best().residual <= options.tolerance) report.status = SolveStatus::converged;
  return loop.best();
}

}  // namespace aussois
