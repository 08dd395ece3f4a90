// SPDX-License-Identifier: Apache-2.0
// Solves one contact: finds r in K_mu with u = W r + q, u + mu |u_T| e_N in K*, orthogonal to r (NSGS-3). See
// (ONE-1) to (ONE-6) in doc/theory/one_contact.md. Everything inside is free of units: W is divided by
// trace(W)/3 and q by |q|.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

enum class LocalSolver {
  enumerative,    // separation, stick, slip by its compliance (ONE-5)
  alart_curnier,  // semismooth Newton
  projection,     // one projection step
  hybrid,         // Newton, with (ONE-5) as fail-safe
};

struct LocalSolution {
  Vec3 r = Vec3::Zero();   // normal first [N s]
  bool solved = true;      // the scaled natural map of this contact is below the local tolerance (ONE-6)
  bool fail_safe = false;  // (ONE-5) was needed
};

/// W need not be symmetric; its symmetric part should be positive semidefinite with W_NN > 0. If a block has
/// several solutions, separation takes precedence over stick, and stick over slip. Never fails silently:
/// `solved` is false if no candidate meets the tolerance, and r is then the best one. Numbers that are not
/// finite, or a W whose trace is not positive, give r = 0 and `solved` false.
LocalSolution solve_one_contact(const Mat3& W, const Vec3& q, double mu, const Vec3& r_start,
                                LocalSolver solver = LocalSolver::hybrid);

}  // namespace aussois
