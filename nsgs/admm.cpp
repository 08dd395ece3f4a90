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

constexpr double kFirstPenalty = 1e-3;  // of the largest eigenvalue of W
constexpr int kFirstInterval = 20;      // steps until the penalty is reconsidered
constexpr double kImbalance = 3;
// of a settling phase (AUTO-5)
constexpr double kSettling = 1e-3;  // penalty, of the unit diagonal of W
constexpr int kSettlingSteps = 20, kSettlingStart = 4;
constexpr double kSettlingRate = 0.5;

// The point v of the splitting stands for impulses z = P(v) and velocities -y = penalty (z - v) at once.
struct Splitting {
  Delassus& W;
  double relaxation = 1;
  double penalty = 1;
  LinearSolve inverse{};  // (W + penalty)^-1

  bool factorise(double new_penalty) {
    penalty = new_penalty;
    inverse = W.shifted_inverse(penalty);
    return bool(inverse);
  }
  VecX impulses(const VecX& v) const { return projected_impulses(v, W.scaled.laws); }
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
  out.v = split.relaxation * x + (1 - split.relaxation) * z + y / split.penalty;  // (ADMM-3)
  const VecX z_new = split.impulses(out.v);
  out.primal = (x - z_new).norm() / std::max({x.norm(), z_new.norm(), 1e-300});
  out.dual = split.penalty * (z_new - z).norm() / std::max(split.duals(out.v, z_new).norm(), 1.0);
  return out;
}

// Replaces `after` by where the last steps together point to, if the judge prefers that (AA-3).
std::optional<Iterate> accelerated(const Splitting& split, Anderson& anderson, const Iterate& now,
                                   const VecX& before, VecX& after) {
  const VecX proposed = anderson.propose(before, after);
  if (proposed.size() == 0) return std::nullopt;
  Iterate ahead = judged(split.W, split.impulses(proposed), Method::admm);
  if (ahead.residual < now.residual) {
    after = proposed;
    return ahead;
  }
  anderson.forget();
  return std::nullopt;
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

Iterate settled(Delassus& W, const Iterate& start, double tolerance) {
  Iterate best = start;
  Splitting split{W};
  if (!split.factorise(kSettling)) return best;
  VecX v = VecX::Zero(start.r.size());
  for (int step = 1; step <= kSettlingSteps; ++step) {
    v = advanced(split, v).v;
    Iterate now = judged(W, split.impulses(v), Method::admm);
    const bool falls = now.residual < kSettlingRate * best.residual;
    if (now.residual < best.residual) best = std::move(now);
    if (best.residual <= tolerance || (step > kSettlingStart && !falls)) break;
  }
  return best;
}

Iterate admm(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  BestSoFar best(start);
  Iterate now = start;
  Splitting split{W, options.relaxation};
  Anderson anderson(options.anderson);
  JudgeSchedule schedule;
  int interval = kFirstInterval, reconsider = kFirstInterval;
  report.status = SolveStatus::not_finite;
  if (!split.factorise(kFirstPenalty * largest_eigenvalue(W))) return start;
  VecX v = split.point(start.r, -modified(W, start.u));  // a solution is a fixed point
  report.status = SolveStatus::max_iterations;
  while (report.iterations < options.max_iterations) {
    SplittingStep step = advanced(split, v);
    ++report.iterations;
    std::optional<Iterate> ahead = accelerated(split, anderson, now, v, step.v);
    v = std::move(step.v);
    if (ahead || options.anderson > 0 ||
        schedule.due(report.iterations, step.primal + step.dual, options.tolerance) ||
        report.iterations == options.max_iterations) {
      now = ahead ? *std::move(ahead) : judged(W, split.impulses(v), Method::admm);
      if (best.ends(now, report.iterations, options.tolerance, report.status)) break;
    }
    if (report.iterations < reconsider) continue;
    interval += interval / 2;
    reconsider = report.iterations + interval;
    const double balance = step.primal / std::max(step.dual, 1e-300);  // (ADMM-6)
    if (balance < kImbalance && balance > 1 / kImbalance) continue;
    const VecX z = split.impulses(v), y = split.duals(v, z);
    if (!split.factorise(split.penalty * std::clamp(std::sqrt(balance), 0.1, 10.0))) break;
    v = split.point(z, y);
    anderson.forget();
  }
  return best.iterate();
}

}  // namespace aussois
