// SPDX-License-Identifier: Apache-2.0
// W~ of the scaled problem as the methods need it: velocities, one sweep, and the linear systems of Newton.
// It has two forms: the matrix itself, and bodies with their contacts, where the matrix is never formed
// (NSGS-5). Private to nsgs.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "nsgs/joint_elimination.hpp"
#include "nsgs/one_contact.hpp"
#include "nsgs/scaled_problem.hpp"

namespace aussois {

struct SweepOptions {
  LocalSolver local = LocalSolver::hybrid;
  double relaxation = 1;
};
/// What a sweep did to one block.
struct BlockChange {
  double change = 0;  // squared norm of the change of its r
  bool failed = false, fail_safe = false;
};
struct SweepCounts {
  int failures = 0, fail_safes = 0;
  double add(const BlockChange& block) {  // returns its change
    failures += block.failed;
    fail_safes += block.fail_safe;
    return block.change;
  }
};
/// The new impulses of block c from its present velocities and impulses.
using BlockRule = std::function<AnyRows(int c, const AnyRows& u, const AnyRows& r)>;
/// Solves A x = b for one factorised A; empty if A is singular.
using LinearSolve = std::function<VecX(const VecX&)>;
/// The same, where a solve may find that there is no solution.
using NewtonSolve = std::function<std::optional<VecX>(const VecX&)>;

/// Refinements of a solution of Newton's linear systems, factor by factor (PROX-8).
inline constexpr int kRefinements = 2;

class Delassus {
 public:
  virtual ~Delassus() = default;

  Scaling scaled{};
  std::vector<int> first{};  // first row of every block
  int count() const { return int(scaled.laws.size()); }

  /// u = W r + q, computed afresh so that rounding does not accumulate. The sweeps that follow start from
  /// here.
  virtual VecX velocity(const VecX& r) = 0;
  /// One pass over the blocks in their order, from the r of the last velocity() or sweep(). Returns the size
  /// of the change of r.
  double sweep(VecX& r, const SweepOptions& options, SweepCounts& counts) {
    double change = 0;
    for (int c = 0; c < count(); ++c) change += counts.add(relax(c, r, options));
    return std::sqrt(change);
  }

  /// One block of such a pass. Blocks of one colour may be relaxed in parallel.
  virtual BlockChange relax(int c, VecX& r, const SweepOptions& options) = 0;
  /// The colour of every block: no two blocks that share velocities have the same (COL-1).
  virtual std::vector<int> colours() const = 0;

  /// The same pass with another rule, which is also applied to open blocks.
  virtual double sweep(VecX& r, const BlockRule& rule) = 0;

  virtual AnyBlock block(int c) const = 0;  // on the diagonal of W
  virtual SparseMatrix matrix() const = 0;  // W
  /// (W + shift)^-1 with shift > 0, factorised once, in the same form as W.
  virtual LinearSolve shifted_inverse(double shift) const = 0;

  // Newton's unknowns d are changes of the velocities of the bodies: A d = B dr, du = C d. Where there are no
  // bodies, they are those of the contacts: A = C = 1, B = W.
  virtual Eigen::Index unknowns() const = 0;
  virtual VecX A(const VecX& d) const = 0;
  virtual VecX B(const VecX& dr) const = 0;
  virtual VecX C(const VecX& d) const = 0;
  virtual double size(const VecX& row_of_A) const = 0;  // free of units
  /// Solves (A + B D C) d = F for d, with D block diagonal, factorised once; valid until the next one is
  /// made. Empty, or without an answer, if the matrix is singular.
  virtual NewtonSolve newton_inverse(std::vector<AnyBlock> D) = 0;
  /// The approximate cost of a Newton iteration in sweeps, if the blocks with r = 0 stay open.
  virtual double newton_cost(const VecX& r) = 0;
};

std::unique_ptr<Delassus> make_delassus(const LocalProblem& problem);
/// M must consist of small blocks, and there must be neither joints nor compliance.
std::unique_ptr<Delassus> make_delassus(const FrictionProblem& problem, const MassInverse& inverse);

}  // namespace aussois
