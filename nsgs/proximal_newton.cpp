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
constexpr double kChord = 0.1;         // what an old inverse must bring F down to
constexpr double kGain = 1e-2;         // of a step whose alpha and inverse serve again
constexpr double kLastDigits = 1e-10;  // above, impulses are so large that other ways may round less
constexpr double kNearRounding = 4;    // times (SOL-3): a step that does not halve the residual is the last

VecX answers(const std::vector<Law>& laws, const VecX& s) {  // (PROX-3)
  return with_rows(laws, [&]<int R>() {
    VecX r(s.size());
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      r.segment<R>(k, law.rows) = block_answer<R>(law, s.segment<R>(k, law.rows));
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
  VecX d{}, A_d{}, s{}, r{}, F{};
  double wrong = 0;
};

Trial tried(const Delassus& W, const Iterate& center, double alpha, VecX d, VecX A_d, const VecX& C_d) {
  Trial trial{.d = std::move(d), .A_d = std::move(A_d), .s = center.r - (center.u + C_d) / alpha};
  trial.r = answers(W.scaled.laws, trial.s);
  trial.F = trial.A_d - W.B(trial.r - center.r);  // (PROX-4)
  trial.wrong = W.size(trial.F);
  return trial;
}
Trial tried(const Delassus& W, const Iterate& center, double alpha, const VecX& d) {
  return tried(W, center, alpha, d, W.A(d), W.C(d));
}
Trial tried(const Delassus& W, const Iterate& center, double alpha) {  // d = 0
  const VecX zero = VecX::Zero(W.unknowns());
  return tried(W, center, alpha, zero, zero, VecX::Zero(center.r.size()));
}

}  // namespace

ProximalStep proximal_step(Delassus& W, const Iterate& center, double alpha, double accuracy,
                           NewtonSolve& inverse) {
  const double momentum = W.size(W.B(center.r)), rounding = kRounding * momentum;
  ProximalStep step;
  Trial now = tried(W, center, alpha);
  for (; step.iterations < kNewtonSteps; ++step.iterations) {
    step.solved = now.wrong <= accuracy * W.size(now.A_d) + rounding;
    if (step.solved || !std::isfinite(now.wrong)) break;
    bool moved = false;
    if (inverse)  // of the solve before (PROX-10)
      if (const std::optional<VecX> direction = inverse(now.F)) {
        Trial next = tried(W, center, alpha, now.d - *direction);
        moved = next.wrong < kChord * now.wrong;
        if (moved) now = std::move(next);
      }
    if (moved) continue;
    inverse = W.newton_inverse(derivatives(W.scaled.laws, now.s, alpha));
    const std::optional<VecX> direction = inverse ? inverse(now.F) : std::nullopt;
    if (!direction) break;
    ++step.factorised;
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
  NewtonSolve inverse;  // of the last Newton matrix with this alpha
  int iterations = 0;
  for (int step = 0; step < options.max_steps && iterations < options.max_iterations &&
                     best.residual > options.tolerance && alpha <= kLargestAlpha;
       ++step) {
    const ProximalStep proximal = proximal_step(W, center, alpha, options.accuracy, inverse);
    iterations += proximal.iterations;
    Iterate iterate = judged(W, proximal.r, Method::proximal_newton);
    const bool idle = iterate.residual > best.residual / 2;
    const bool gained = proximal.solved && iterate.residual <= kGain * center.residual;
    if (proximal.solved || iterate.residual < best.residual) center = iterate;
    if (iterate.residual < best.residual) best = std::move(iterate);
    if (idle && best.residual <= kLastDigits && is_at_rounding(W, best, kNearRounding)) break;
    if (gained && proximal.factorised <= 1) continue;  // (PROX-10)
    inverse = {};
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
  Iterate best =
      proximal_steps(W, start, {.tolerance = options.tolerance, .max_steps = options.max_iterations}, report);
  report.iterations = report.newton_iterations;
  report.status = best.residual <= options.tolerance ? SolveStatus::converged : SolveStatus::stagnated;
  return best;
}

}  // namespace aussois
