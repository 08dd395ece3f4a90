// SPDX-License-Identifier: Apache-2.0
// Accelerated projected gradient (APG-1) to (APG-6) on the convex problem of the cone model; Coulomb's law by
// a sequence of such problems. Sources: Nesterov 1983; O'Donoghue and Candes 2015 (restart); Mazhar, Heyn,
// Tasora and Negrut 2015; Acary and Cadoux 2013 (the sequence).
#include <algorithm>
#include <cmath>

#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 3000;         // steps without halving the best residual
constexpr double kForget = 0.95;        // of the bound on the curvature, per step
constexpr double kInnerAccuracy = 0.2;  // of a convex problem, relative to what its De Saxce term is off

VecX de_saxce_term(const Delassus& W, const VecX& u) {
  if (W.scaled.model == FrictionModel::convex_cone) return VecX::Zero(u.size());
  return modified_velocities(u, W.scaled.laws) - u;
}

struct Point {
  VecX r{}, u{};
};

}  // namespace

Iterate projected_gradient(Delassus& W, const Iterate& start, const SolverOptions& options,
                           SolveReport& report) {
  const std::vector<Law>& laws = W.scaled.laws;
  BestSoFar best(start, kPatience);
  Point now{start.r, start.u}, ahead = now;
  VecX term = de_saxce_term(W, start.u);
  double curvature = 1, momentum = 1;
  report.status = SolveStatus::max_iterations;
  while (report.iterations < options.max_iterations) {
    ++report.iterations;
    const VecX gradient = ahead.u + term;  // (APG-1)
    Point next;
    for (;; curvature *= 2) {
      next.r = projected_impulses(ahead.r - gradient / curvature, laws);  // (APG-2)
      next.u = W.velocity(next.r);
      const VecX d = next.r - ahead.r;
      if (!(d.dot(next.u - ahead.u) > curvature * d.squaredNorm() * (1 + 1e-12))) break;  // (APG-3)
    }
    curvature *= kForget;
    const double momentum_next = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
    double push = (momentum - 1) / momentum_next;
    momentum = momentum_next;
    if (gradient.dot(next.r - now.r) > 0) momentum = 1, push = 0;  // (APG-5)
    ahead.r = next.r + push * (next.r - now.r);                    // (APG-4)
    ahead.u = next.u + push * (next.u - now.u);
    now = std::move(next);

    const double residual = natural_map(now.u, now.r, laws, W.scaled.model);
    const Iterate judged{now.r, now.u, std::isfinite(residual) ? residual : kInf, Method::projected_gradient};
    if (best.ends(judged, report.iterations, options.tolerance, report.status)) break;
    if (W.scaled.model == FrictionModel::convex_cone) continue;
    const VecX term_now = de_saxce_term(W, now.u);
    const double convex = (now.r - projected_impulses(now.r - now.u - term, laws)).norm();
    if (convex > kInnerAccuracy * (term_now - term).norm()) continue;
    term = term_now;  // (APG-6): the next convex problem
    momentum = 1;
    ahead = now;
  }
  return best.iterate();
}

}  // namespace aussois
