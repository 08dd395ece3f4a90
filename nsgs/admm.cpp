// SPDX-License-Identifier: Apache-2.0
// Splitting (ADMM-1) to (ADMM-6): a linear problem with a penalty and nearest points of the sets in turn.
// Sources: Boyd et al. 2011; Tasora, Mangoni, Benatti and Garziera 2021; Carpentier, Le Lidec and Montaut
// 2024.
#include <algorithm>
#include <cmath>

#include "nsgs/anderson.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 1000;  // steps without halving the best residual
constexpr double kOverRelaxation = 1.6;
constexpr double kFirstPenalty = 0.1;  // of the largest eigenvalue of W
constexpr int kFirstInterval = 20;     // steps until the penalty is reconsidered
constexpr double kImbalance = 3;

// The point v of the splitting stands for impulses z = P(v) and velocities -y = penalty (z - v) at once.
struct Splitting {
  Delassus& W;
  double penalty = 1;
  LinearSolve inverse{};  // (W + penalty)^-1

  bool factorise(double new_penalty) {
    penalty = new_penalty;
    inverse = W.shifted_inverse(penalty);
    return bool(inverse);
  }
  VecX impulses(const VecX& v) const { return projected(v, W.scaled.laws); }
  VecX duals(const VecX& v, const VecX& z) const { return penalty * (v - z); }
  VecX point(const VecX& z, const VecX& y) const { return z + y / penalty; }
};

VecX modified(const Delassus& W, const VecX& u) {
  return W.scaled.model == FrictionModel::coulomb ? modified_velocities(u, W.scaled.laws) : u;
}

struct SplittingStep {
  VecX v{};
  double primal = 0, dual = 0;  // (ADMM-5), relative
};

SplittingStep advanced(const Splitting& split, const VecX& v) {
  const VecX z = split.impulses(v), y = split.duals(v, z);
  const VecX shift = modified(split.W, -y) + y;  // De Saxce's term of the moment
  const VecX x = split.inverse(split.penalty * z - y - split.W.scaled.q - shift);  // (ADMM-2)
  SplittingStep out;
  out.v = kOverRelaxation * x + (1 - kOverRelaxation) * z + y / split.penalty;  // (ADMM-3)
  const VecX z_new = split.impulses(out.v);
  out.primal = (x - z_new).norm() / std::max({x.norm(), z_new.norm(), 1e-300});
  out.dual = split.penalty * (z_new - z).norm() / std::max(split.duals(out.v, z_new).norm(), 1.0);
  return out;
}

double largest_eigenvalue(Delassus& W) {  // about, by power iteration
  VecX x(W.scaled.q.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = 1 + 0.5 * std::sin(double(i));
  double size = 1;
  for (int step = 0; step < 20; ++step) {
    x = W.velocity(x / x.norm()) - W.scaled.q;
    size = x.norm();
    if (!(size > 0)) return 1;
  }
  return size;
}

}  // namespace

Iterate admm(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  Iterate best = start, now = start;
  Splitting split{W};
  Anderson anderson(options.anderson);
  JudgeSchedule schedule;
  double halved = best.residual;
  int halved_at = 0, interval = kFirstInterval, reconsider = kFirstInterval;
  if (!split.factorise(kFirstPenalty * largest_eigenvalue(W))) {
    report.status = SolveStatus::not_finite;
    return best;
  }
  VecX v = split.point(start.r, -modified(W, start.u));  // a solution is a fixed point
  report.status = SolveStatus::max_iterations;
  while (best.residual > options.tolerance && report.iterations < options.max_iterations) {
    SplittingStep step = advanced(split, v);
    ++report.iterations;
    const VecX proposed = anderson.propose(v, step.v);
    if (proposed.size() > 0) {
      Iterate ahead = judged(W, split.impulses(proposed), Method::admm);
      if (ahead.residual < now.residual) {  // (AA-3)
        step.v = proposed;
        now = std::move(ahead);
      } else {
        anderson.forget();
      }
    }
    v = std::move(step.v);
    if (report.iterations >= reconsider) {  // (ADMM-6)
      const double balance = step.primal / std::max(step.dual, 1e-300);
      interval += interval / 2;
      reconsider = report.iterations + interval;
      if (balance > kImbalance || balance < 1 / kImbalance) {
        const VecX z = split.impulses(v), y = split.duals(v, z);
        if (!split.factorise(split.penalty * std::clamp(std::sqrt(balance), 0.1, 10.0))) break;
        v = split.point(z, y);
        anderson.forget();
      }
    }
    if (options.anderson == 0 &&
        !schedule.due(report.iterations, step.primal + step.dual, options.tolerance) &&
        report.iterations < options.max_iterations)
      continue;
    now = judged(W, split.impulses(v), Method::admm);
    if (now.residual == kInf) {
      report.status = SolveStatus::not_finite;
      break;
    }
    if (now.residual < best.residual) best = now;
    if (best.residual <= halved / 2) halved = best.residual, halved_at = report.iterations;
    if (report.iterations - halved_at >= kPatience) {
      report.status = SolveStatus::stagnated;
      break;
    }
  }
  if (best.residual <= options.tolerance) report.status = SolveStatus::converged;
  return best;
}

}  // namespace aussois
