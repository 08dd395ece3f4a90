// SPDX-License-Identifier: Apache-2.0
// What the methods pass to each other: an iterate with the judge's verdict on it. Private to nsgs. Every
// method takes a start, keeps the best iterate that it meets, returns it, and reports its status.
#pragma once

#include "nsgs/delassus.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

/// A remainder of this fraction of terms that cancel, in q or in W r + q, is as good as zero (SOL-3).
inline constexpr double kCancellation = 1e-15;

struct Iterate {
  VecX r{}, u{};  // scaled
  double residual = kInf;
  Method by = Method::automatic;
};

/// Computes the velocities of r afresh and asks the judge. A residual that is not finite becomes infinite.
Iterate judged(Delassus& W, VecX r, Method by);

/// Whether the residual is at most `times` what rounding of W r and q may make of it (SOL-3). Costs as much
/// as forming W.
bool is_at_rounding(const Delassus& W, const Iterate& iterate, double times = 1);

/// Decides when the judge is asked, because a product with W costs as much as a sweep: at each of the first
/// sweeps, then at growing intervals, and whenever r changes by no more than the tolerance.
class JudgeSchedule {
 public:
  bool due(int iteration, double change, double tolerance);

 private:
  int next_ = 1;
};

/// The best iterate met, and when to give up (FIX-2).
class BestSoFar {
 public:
  explicit BestSoFar(const Iterate& start, int patience = 1000)
      : best_(start), halved_(start.residual), patience_(patience) {}
  const Iterate& iterate() const { return best_; }
  void offer(Iterate other, int step);  // kept if it is the best
  bool stagnated(int step) const { return step - halved_at_ >= patience_; }
  /// Takes in the judge's verdict after a step. If true, the method ends and `status` says how.
  bool ends(const Iterate& now, int step, double tolerance, SolveStatus& status);

 private:
  Iterate best_;
  double halved_;
  int halved_at_ = 0, patience_;
};

/// Calls f(i) for all i in [0, n), by options.for_all if there is one.
inline void for_all(const SolverOptions& options, int n, const std::function<void(int)>& f) {
  if (options.for_all && n > 1) return options.for_all(n, f);
  for (int i = 0; i < n; ++i) f(i);
}

/// Runs options.method.
Iterate run_method(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);

Iterate nsgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate coloured_nsgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate sor_prox(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate jor_prox(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate coulomb_pgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate proximal_newton(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate admm(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
Iterate projected_gradient(Delassus& W, const Iterate& start, const SolverOptions& options,
                           SolveReport& report);
Iterate interior_point(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);
/// Takes a few steps of admm with a small penalty, as long as they converge fast. Where all contacts stick or
/// open, they finish what would take sweeps hundreds of passes (AUTO-5). Returns the best iterate met.
Iterate settled(Delassus& W, const Iterate& start, double tolerance);
Iterate automatic(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);

}  // namespace aussois
