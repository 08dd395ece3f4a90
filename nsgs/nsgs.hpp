// SPDX-License-Identifier: Apache-2.0
// Nonsmooth Gauss-Seidel (NSGS-4) to (NSGS-7): one contact after the other, each solved exactly; where that
// contracts poorly, which is the rule for hyperstatic problems, the proximal Newton phase of
// doc/theory/proximal_newton.md. Source: Jean and Moreau 1992; Acary and Brogliato 2008, ch. 13.
#pragma once

#include "nsgs/friction_problem.hpp"
#include "nsgs/one_contact.hpp"

namespace aussois {

enum class SolveStatus {
  converged,       // the residual is within the tolerance
  stagnated,       // 1000 sweeps without halving the best residual, and Newton could not help
  max_iterations,  // the sweeps are used up
  not_finite,  // a number of the problem or of the iteration is not finite, M is singular, or a W_cc is zero
};
const char* to_string(SolveStatus status);

struct SolveReport {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;               // sweeps
  int newton_iterations = 0;        // linear solves of the second phase
  bool finished_by_newton = false;  // the returned iterate comes from the second phase
  double residual = 0;              // scaled_residual of what is returned (NSGS-9)
  int local_failures = 0;           // one-contact problems that no local method solved to its tolerance
  int local_fail_safes = 0;         // one-contact problems that Newton gave to the enumeration
};

struct NsgsOptions {
  double tolerance = 1e-8;     // on the scaled residual [-], in (0, 1)
  int max_iterations = 10000;  // sweeps, >= 1
  double relaxation = 1.0;     // in (0, 1]
  int check_every = 1;         // sweeps between two evaluations of the residual, >= 1
  LocalSolver local = LocalSolver::hybrid;
  // Sweeps until their contraction is judged and Newton may take over, >= 0; 0: never
  int handover_after = 5;
};
void validate(const NsgsOptions& options);  // throws std::invalid_argument: field, value, bound

struct FrictionSolution {
  VecX v{};  // generalised velocity, n [m/s, rad/s] (empty for a LocalProblem)
  VecX u{};  // relative velocity with the bias, 3c [m/s]
  VecX r{};  // impulses, 3c, normal first [N s]
  SolveReport report{};
};

/// Matrix-free: sweeps act on the velocity through the columns of H and M^-1 H (NSGS-5); where M couples more
/// than kLargestMassBlock rows, on the condensed problem. `r0` is the start (3c) or empty for zero; it is
/// projected on the cones, and is the answer, without a sweep, if it is good enough. Throws
/// std::invalid_argument for inconsistent sizes and options; never for numerical trouble: then the best
/// iterate and a status.
FrictionSolution solve_nsgs(const FrictionProblem& problem, const VecX& r0, const NsgsOptions& options = {});
/// On the Delassus operator.
FrictionSolution solve_nsgs(const LocalProblem& problem, const VecX& r0, const NsgsOptions& options = {});

}  // namespace aussois
