// SPDX-License-Identifier: Apache-2.0
// Nonsmooth Gauss-Seidel (NSGS-4) to (NSGS-7): one contact after the other, each solved exactly.
// Source: Jean and Moreau 1992; Acary and Brogliato 2008, ch. 13.
#pragma once

#include "nsgs/friction_problem.hpp"
#include "nsgs/one_contact.hpp"

namespace aussois {

enum class SolveStatus { converged, stagnated, max_iterations, not_finite };
const char* to_string(SolveStatus status);

struct SolveReport {
  SolveStatus status = SolveStatus::converged;
  int iterations = 0;         // sweeps
  double residual = 0;        // scaled_residual of what is returned (NSGS-9)
  int local_failures = 0;     // one-contact problems that no local method solved to its tolerance
  int local_fail_safes = 0;   // one-contact problems that Newton gave to the enumeration
};

struct NsgsOptions {
  double tolerance = 1e-8;      // on the scaled residual [-], in (0, 1)
  int max_iterations = 10000;   // sweeps, >= 1
  double relaxation = 1.0;      // in (0, 1]
  int check_every = 1;          // sweeps between two evaluations of the residual, >= 1
  LocalSolver local = LocalSolver::hybrid;
};
void validate(const NsgsOptions& options);  // throws std::invalid_argument: field, value, bound

struct FrictionSolution {
  VecX v{};  // generalised velocity, n [m/s, rad/s] (empty for a LocalProblem)
  VecX u{};  // relative velocity with the bias, 3c [m/s]
  VecX r{};  // impulses, 3c, normal first [N s]
  SolveReport report{};
};

/// Matrix-free: sweeps act on the velocity through the columns of H and M^-1 H (NSGS-5). `r0` is the start (3c) or
/// empty for zero; it is projected on the cones. Never throws for numerical trouble: the best iterate and a status.
FrictionSolution solve_nsgs(const FrictionProblem& problem, const VecX& r0, const NsgsOptions& options = {});
/// On the Delassus operator.
FrictionSolution solve_nsgs(const LocalProblem& problem, const VecX& r0, const NsgsOptions& options = {});

}  // namespace aussois
