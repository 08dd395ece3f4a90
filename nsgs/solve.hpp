// SPDX-License-Identifier: Apache-2.0
// The single entry to all solvers (SOL-1): options choose the method, and residuals outside all methods judge
// the result.
#pragma once

#include <functional>
#include <string>

#include "nsgs/friction_problem.hpp"
#include "nsgs/mass_inverse.hpp"
#include "nsgs/one_contact.hpp"

namespace aussois {

class SettingVisitor;

enum class Method {
  automatic,           // the default: NSGS while it contracts, then Newton (automatic.md)
  nsgs,                // nonsmooth Gauss-Seidel, one block after the other solved exactly (nsgs.md)
  coloured_nsgs,       // the same in another order, blocks of a colour in parallel (coloured_nsgs.md)
  sor_prox,            // one projection per block in Gauss-Seidel order (prox.md)
  jor_prox,            // the same in Jacobi order
  coulomb_pgs,         // sor_prox with one step size per block and part, as engines do it (prox.md)
  proximal_newton,     // semismooth Newton inside proximal steps (proximal_newton.md)
  admm,                // splitting with a spectral penalty (admm.md)
  projected_gradient,  // accelerated, by convex problems (projected_gradient.md)
  interior_point,      // with Nesterov-Todd scaling (interior_point.md)
};
const char* to_string(Method method);
/// The method with this name; throws std::invalid_argument listing all names.
Method method(const std::string& name);

/// R of the prox methods, from the blocks of W (SORP-3).
enum class ProxMetric {
  blocks,    // inverses of the normal and of the tangential blocks: prox on ellipsoids
  split,     // 1 / largest eigenvalue of each of them: prox on disks
  spectral,  // 1 / largest eigenvalue of the whole block
};

enum class SolveStatus {  // of several islands, the last status in this order counts
  converged,              // the residual is within the tolerance
  at_rounding,            // above the tolerance, but within rounding (SOL-3): as good as it gets
  stagnated,              // the residual no longer falls, nothing else helped: limit cycle or no solution
  max_iterations,         // the iterations are used up
  not_finite,  // a number of the problem or iteration is not finite, M is singular, or a block of W is zero
};
const char* to_string(SolveStatus status);
/// Converged, or as good as arithmetic allows.
inline bool is_solved(SolveStatus status) {
  return status <= SolveStatus::at_rounding;
}

/// `describe` gives the ranges, and the methods that read an option: with others only its default is taken.
struct SolverOptions {
  Method method = Method::automatic;
  FrictionModel model = FrictionModel::coulomb;  // convex_cone: admm, projected_gradient, interior_point
  double tolerance = 1e-8;     // on the scaled residual of each island [-]; what it is worth: SOL-4
  int max_iterations = 10000;  // sweeps or steps of the method
  double relaxation = 1.0;
  LocalSolver local = LocalSolver::hybrid;
  ProxMetric prox = ProxMetric::blocks;
  int anderson = 0;             // iterates combined by Anderson acceleration
  bool estimate_error = false;  // continue from the answer, which stays the same, to find SolveReport::error
  /// Calls f(i) for all i in [0, n) in any order, on as many threads as it has, and returns when all are
  /// done. Used for islands and for the blocks of a colour. Empty: one after the other. No result depends on
  /// it.
  std::function<void(int n, const std::function<void(int)>& f)> for_all{};
};
void validate(const SolverOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, SolverOptions& options);  // all but for_all

struct SolveReport {
  SolveStatus status = SolveStatus::converged;
  Method found_by = Method::automatic;  // the phase that the returned iterate comes from
  int iterations = 0;                   // sweeps or steps
  int newton_iterations = 0;            // linear solves of Newton phases
  double residual = 0;          // scaled_residual of what is returned (NSGS-9), for the model asked for; with
                                // a KnownMotion, at least that
  double worst_island = 0;      // the largest residual of an island, relative to its own |q|: the one held to
                                // the tolerance
  double coulomb_residual = 0;  // residual of Coulomb's law, whatever the model
  double error = -1;  // |u - better u| / |q|, scaled, the largest of all islands (SOL-4): an estimate of how
                      // far the velocities are from exact ones; equal to the residual if that is at most
                      // 1e-13; infinite if no answer with a tenth of the residual was found; negative: not
                      // asked for, no rows, or a model other than Coulomb's
  int local_failures = 0;    // one-block problems that no local method solved to its tolerance
  int local_fail_safes = 0;  // one-block problems that Newton gave to its fail-safe
};

struct FrictionSolution {
  VecX v{};       // generalised velocity, n [m/s, rad/s] (empty for a LocalProblem)
  VecX u{};       // relative velocity with bias and compliance, m [m/s]
  VecX r{};       // impulses, m, normal first [N s]
  VecX lambda{};  // impulses of the joints, p [N s, N m s]; of smallest norm if joints are redundant
  SolveReport report{};
};

/// `r0` is the start (m) or empty for zero; it is projected on the sets of the laws, and is the answer,
/// without an iteration, if it is good enough. Throws std::invalid_argument for inconsistent sizes and
/// options, but never for numerical trouble: that gives the best iterate and a status.
FrictionSolution solve(const FrictionProblem& problem, const VecX& r0, const SolverOptions& options = {});
FrictionSolution solve(const LocalProblem& problem, const VecX& r0, const SolverOptions& options = {});

/// M^-1 and M^-1 f of a problem, for a caller that has them already.
struct KnownMotion {
  const MassInverse& inverse;
  const VecX& v_free;  // n [m/s, rad/s]
};
/// Solves the same problem to the same tolerance, but faster: bodies without contacts are not looked at, and
/// blocks that open whatever the others do are left out (ISL-2). They are also left out of |q| in the
/// report's residuals, which are therefore not less than those of the whole. With joints, `known` is of no
/// use and is ignored.
FrictionSolution solve(const FrictionProblem& problem, const KnownMotion& known, const VecX& r0,
                       const SolverOptions& options = {});

}  // namespace aussois
