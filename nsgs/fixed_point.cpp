// SPDX-License-Identifier: Apache-2.0
#include "nsgs/fixed_point.hpp"

#include "nsgs/anderson.hpp"

namespace aussois {

namespace {

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
  BestSoFar best(start);
  Iterate now = start;
  Anderson anderson(options.anderson);
  JudgeSchedule schedule;
  W.velocity(now.r);
  report.status = SolveStatus::max_iterations;
  while (report.iterations < options.max_iterations) {
    VecX r = options.anderson > 0 ? now.r : std::move(now.r);
    const double change = step(r);
    ++report.iterations;
    std::optional<Iterate> ahead;
    if (options.anderson > 0) {
      ahead = accelerated(W, anderson, now, r);
    } else if (!schedule.due(report.iterations, change, options.tolerance) &&
               report.iterations < options.max_iterations) {
      now.r = std::move(r);
      continue;
    }
    now = ahead ? *std::move(ahead) : judged(W, std::move(r), by);
    if (best.ends(now, report.iterations, options.tolerance, report.status)) break;
  }
  return best.iterate();
}

}  // namespace aussois
