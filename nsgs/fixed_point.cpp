// SPDX-License-Identifier: Apache-2.0
#include "nsgs/fixed_point.hpp"

#include "nsgs/anderson.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 1000;  // steps without halving the best residual

// Where the last steps together point to, if the judge prefers it to where this one began (AA-3). Otherwise
// nothing, and W is left at that place.
std::optional<Iterate> accelerated(Delassus& W, Anderson& anderson, const Iterate& before,
                                   const VecX& after) {
  const VecX proposed = anderson.propose(before.r, after);
  if (proposed.size() == 0) return std::nullopt;
  Iterate iterate = judged(W, projected(proposed, W.scaled.laws), before.by);
  if (iterate.residual < before.residual) return iterate;
  anderson.forget();
  return std::nullopt;
}

}  // namespace

Iterate fixed_point(Delassus& W, const Iterate& start, Method by, const SolverOptions& options,
                    SolveReport& report, const Step& step) {
  Iterate best = start, now = start;
  Anderson anderson(options.anderson);
  JudgeSchedule schedule;
  double halved = best.residual;
  int halved_at = 0;
  W.velocity(now.r);
  report.status = SolveStatus::max_iterations;
  while (best.residual > options.tolerance && report.iterations < options.max_iterations) {
    VecX r = options.anderson > 0 ? now.r : std::move(now.r);
    const double change = step(r);
    ++report.iterations;
    if (options.anderson > 0) {
      std::optional<Iterate> ahead = accelerated(W, anderson, now, r);
      now = ahead ? *std::move(ahead) : judged(W, std::move(r), by);
    } else {
      now.r = std::move(r);
      if (!schedule.due(report.iterations, change, options.tolerance) &&
          report.iterations < options.max_iterations)
        continue;
      now = judged(W, std::move(now.r), by);
    }
    if (now.residual == kInf) {
      report.status = SolveStatus::not_finite;
      break;
    }
    if (now.residual < best.residual) best = now;
    if (best.residual <= halved / 2) halved = best.residual, halved_at = report.iterations;
    if (report.iterations - halved_at >= kPatience) {  // (FIX-2)
      report.status = SolveStatus::stagnated;
      break;
    }
  }
  if (best.residual <= options.tolerance) report.status = SolveStatus::converged;
  return best;
}

}  // namespace aussois
