// SPDX-License-Identifier: Apache-2.0
// The one-step problem in FCLIB's notation, seen from the bodies (NSGS-1) and from the contacts (NSGS-2).
// Every block of rows has a law; for frictional contacts K* contains u + mu |u_T| e_N, orthogonal to r in K.
#pragma once

#include <vector>

#include "nsgs/law.hpp"

namespace aussois {

/// M v = H r + G lambda + f,   G^T v + b = 0,   u = H^T v + R r + w.
struct FrictionProblem {
  SparseMatrix M{};         // n x n, positive definite, not necessarily symmetric [kg, kg m, kg m^2]
  SparseMatrix H{};         // n x m, directions of the rows as columns, block after block [-, m]
  VecX f{};                 // free momentum, n [N s, N m s]
  VecX w{};                 // bias from restitution, gap and moved bodies, m [m/s, rad/s]
  std::vector<Law> laws{};  // of the blocks, in order; their rows add up to m
  SparseMatrix G{};         // n x p, directions of the joints; empty without joints. May be rank deficient
  VecX b{};                 // bias of the joints, p
  VecX R{};                 // compliance of the rows, m, >= 0 [1/kg]; empty: rigid
  int contact_count() const { return int(laws.size()); }
};

/// u = W r + q, with W = H^T M^-1 H + R and q = H^T M^-1 f + w where there are no joints.
struct LocalProblem {
  SparseMatrix W{};  // Delassus operator, m x m, not necessarily symmetric [1/kg]
  VecX q{};          // relative velocity without impulses, m [m/s, rad/s]
  std::vector<Law> laws{};
  int contact_count() const { return int(laws.size()); }
};

/// Throws std::invalid_argument naming the field, with both sizes, unless sizes agree and laws are valid.
/// Entries of the matrices and vectors may be anything: those that are not finite lead to a status of the
/// solver.
void validate(const FrictionProblem& problem);
void validate(const LocalProblem& problem);

/// The first row of every block, and at the end the number of rows.
std::vector<int> first_rows(const std::vector<Law>& laws);

/// Eliminates bodies and joints. Throws std::invalid_argument for inconsistent sizes, std::runtime_error if M
/// is singular or not finite.
LocalProblem condense(const FrictionProblem& problem);

}  // namespace aussois
