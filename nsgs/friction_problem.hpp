// SPDX-License-Identifier: Apache-2.0
// The one-step problem in FCLIB's global form and letters (NSGS-1):
//   M v = H r + f,   u = H^T v + w,   K* contains u + mu |u_T| e_N, orthogonal to r in K_mu, per contact.
// Each contact has three rows, normal first. Joints (G, b, lambda) come with the joints.
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct FrictionProblem {
  SparseMatrix M{};          // n x n, positive definite, not necessarily symmetric [kg, kg m, kg m^2]
  SparseMatrix H{};          // n x 3c, contact directions (normal, tangent, tangent) as columns [-, m]
  VecX f{};                  // free momentum, n [N s, N m s]
  VecX w{};                  // bias from restitution, gap and moved bodies, 3c [m/s]
  std::vector<double> mu{};  // one per contact, >= 0 [-]
  int contact_count() const { return int(mu.size()); }
};

/// Throws std::invalid_argument naming the field unless sizes agree and mu is finite and >= 0.
void validate(const FrictionProblem& problem);

/// Square matrix of 3 x 3 blocks in compressed rows, columns ascending, the diagonal block always stored.
struct BlockMatrix {
  std::vector<int> begin{}, column{};
  std::vector<Mat3> block{};
  int rows() const { return begin.empty() ? 0 : int(begin.size()) - 1; }
  const Mat3& diagonal(int i) const;
  Vec3 row_times(int i, const VecX& r) const;
  VecX operator*(const VecX& r) const;
};

/// `A` (3c x 3c) by blocks; blocks without any entry are left out, except on the diagonal.
BlockMatrix block_matrix(const SparseMatrix& A);
SparseMatrix sparse_matrix(const BlockMatrix& W);

/// The same problem seen from the contacts (NSGS-2): u = W r + q, W = H^T M^-1 H, q = H^T M^-1 f + w.
struct LocalProblem {
  BlockMatrix W{};  // Delassus operator [1/kg]
  VecX q{};         // relative velocity without contact impulses [m/s]
  std::vector<double> mu{};
  int contact_count() const { return int(mu.size()); }
};

/// Throws std::invalid_argument naming the field unless sizes and the structure of W agree and mu is finite
/// and >= 0.
void validate(const LocalProblem& problem);

/// Throws std::invalid_argument for inconsistent sizes, std::runtime_error if M is singular or not finite.
LocalProblem condense(const FrictionProblem& problem);

}  // namespace aussois
