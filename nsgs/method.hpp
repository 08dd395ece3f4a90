// SPDX-License-Identifier: Apache-2.0
// What the methods hand to each other: an iterate with what the judge says of it. Private to nsgs. Every
// method takes the start, keeps the best iterate that it meets, returns it, and tells its status.
#pragma once

#include "nsgs/delassus.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

/// Of terms that cancel, in q or in W r + q: as good as zero (SOL-3).
inline constexpr double kCancellation = 1e-15;

struct Iterate {
  VecX r{}, u{};  // scaled
  double residual = kInf;
  Method by = Method::automatic;
};

/// Velocities of r afresh, and the judge. A residual that is not a number becomes infinite.
Iterate judged(Delassus& W, VecX r, Method by);

/// Whether the residual is at most `times` what rounding of W r and q may make of it (SOL-3). As dear as
/// forming W.
bool is_at_rounding(const Delassus& W, const Iterate& iterate, double times = 1);

/// When the judge is asked: a product with W costs as much as a sweep. At each of the first sweeps, then at
/// steps that grow, and when the change of r says that it may be time.
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
  /// Takes in what the judge said after a step. True: the method ends, and `status` says how.
  bool ends(const Iterate& now, int step, double tolerance, SolveStatus& status);

 private:
  Iterate best_;
  double halved_;
  int halved_at_ = 0, patience_;
};

/// As options.for_all says.
inline void for_all(const SolverOptions& options, int n, const std::function<void(int)>& f) {
  if (options.for_all && n > 1) return options.for_all(n, f);
  for (int i = 0; i < n; ++i) f(i);
}

/// By options.method.
Iterate run(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);

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
/// A few steps of admm with a small penalty, as long as they converge fast: where all contacts stick or open
/// they end what sweeps would take hundreds of passes for (AUTO-5). Returns the best iterate met.
Iterate settled(Delassus& W, const Iterate& start, double tolerance);
Iterate automatic(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report);

}  // namespace aussois
