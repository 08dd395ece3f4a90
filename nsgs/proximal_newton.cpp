// SPDX-License-Identifier: Apache-2.0
#include "nsgs/proximal_newton.hpp"

#include <cmath>

namespace aussois {

namespace {

// Measured on random pegs in holes and on the problems of FCLIB, doc/theory/proximal_newton.md.
constexpr double kSmallestAlpha = 1e-8;  // 1e-6 left 1 of 2000 problems above 1e-12
constexpr double kLargestAlpha = 1e3;
constexpr int kEasyStep = 5;      // Newton iterations
constexpr int kNewtonSteps = 30;  // a step that needs more has too small an alpha
constexpr double kRounding = 4e-15;
constexpr double kStalled = 1e-12;
constexpr double kSmallestDamping = 1e-3;

VecX answers(const std::vector<Law>& laws, const VecX& s) {  // (PROX-3)
  return with_rows(laws, [&]<int R>() {
    VecX r(s.size());
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      r.segment<R>(k, law.rows) = answer<R>(law, s.segment<R>(k, law.rows));
      k += law.rows;
    }
    return r;
  });
}

std::vector<AnyBlock> derivatives(const std::vector<Law>& laws, const VecX& s, double alpha) {
  return with_rows(laws, [&]<int R>() {
    std::vector<AnyBlock> D;
    D.reserve(laws.size());
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      D.emplace_back(answer_derivative<R>(law, s.segment<R>(k, law.rows)) / alpha);
      k += law.rows;
    }
    return D;
  });
}

struct Trial {
  VecX d{}, s{}, r{}, F{};
  double wrong = 0;
};

Trial tried(const Delassus& W, const Iterate& center, double alpha, const VecX& d) {
  Trial trial{.d = d, .s = center.r - (center.u + W.C(d)) / alpha};
  trial.r = answers(W.scaled.laws, trial.s);
  trial.F = W.A(d) - W.B(trial.r - center.r);  // (PROX-4)
  trial.wrong = W.size(trial.F);
  return trial;
}

}  // namespace

ProximalStep proximal_step(Delassus& W, const Iterate& center, double alpha, double accuracy) {
  const double momentum = W.size(W.B(center.r)), rounding = kRounding * momentum;
  ProximalStep step;
  Trial now = tried(W, center, alpha, VecX::Zero(W.unknowns()));
  for (; step.iterations < kNewtonSteps; ++step.iterations) {
    step.solved = now.wrong <= accuracy * W.size(W.A(now.d)) + rounding;
    if (step.solved || !std::isfinite(now.wrong)) break;
    const std::optional<VecX> direction = W.direction(derivatives(W.scaled.laws, now.s, alpha), now.F);
    if (!direction) break;
    bool moved = false;
    for (double damping = 1; damping >= kSmallestDamping && !moved; damping /= 2) {  // (PROX-6)
      Trial next = tried(W, center, alpha, now.d - damping * *direction);
      moved = next.wrong < now.wrong * (1 - 1e-4 * damping);
      if (moved) now = std::move(next);
    }
    if (!moved) {  // no direction is better than rounding lets it be: where that is little, it is the end
      step.solved = now.wrong <= kStalled * momentum;
      break;
    }
  }
  step.r = now.r;
  return step;
}

Iterate proximal_steps(Delassus& W, const Iterate& start, const ProximalOptions& options,
                       SolveReport& report) {
  Iterate best = start, center = start;
  double alpha = options.alpha;
  int iterations = 0;
  for (int step = 0; step < options.max_steps && iterations < options.max_iterations &&
                     best.residual > options.tolerance && alpha <= kLargestAlpha;
       ++step) {
    const ProximalStep proximal = proximal_step(W, center, alpha, options.accuracy);
    iterations += proximal.iterations;
    Iterate iterate = judged(W, proximal.r, Method::proximal_newton);
    if (proximal.solved || iterate.residual < best.residual) center = iterate;
    if (iterate.residual < best.residual) best = std::move(iterate);
    if (!proximal.solved)
      alpha *= 10;
    else
      alpha = std::max(alpha / (proximal.iterations <= kEasyStep ? 10 : 3), kSmallestAlpha);
  }
  report.newton_iterations += iterations;
  return best;
}

Iterate proximal_newton(Delassus& W, const Iterate& start, const SolverOptions& options,
                        SolveReport& report) {
  const Iterate best =
      proximal_steps(W, start, {.tolerance = options.tolerance, .max_steps = options.max_iterations}, report);
  report.iterations = report.newton_iterations;
  report.status = best.residual <= options.tolerance ? SolveStatus::converged : SolveStatus::stagnated;
  return best;
}

}  // namespace aussois
