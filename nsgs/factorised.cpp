// SPDX-License-Identifier: Apache-2.0
#include "nsgs/factorised.hpp"

#include <memory>

#include <Eigen/KLUSupport>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

namespace aussois {

namespace {

constexpr Eigen::Index kDenseSize = 150;

template <class Factor>
LinearSolve solve_with(const SparseMatrix& A) {
  const auto factor = std::make_shared<Factor>(A);
  if (factor->info() != Eigen::Success) return {};
  return [factor](const VecX& b) -> VecX { return factor->solve(b); };
}

bool is_symmetric(const SparseMatrix& A) {
  const SparseMatrix transposed = A.transpose();
  return (A - transposed).norm() <= 1e-14 * A.norm();
}

}  // namespace

LinearSolve factorised(const SparseMatrix& A) {
  if (A.rows() > kDenseSize)
    return is_symmetric(A) ? solve_with<Eigen::SimplicialLDLT<SparseMatrix>>(A)
                           : solve_with<Eigen::KLU<SparseMatrix>>(A);
  const auto factor = std::make_shared<Eigen::PartialPivLU<MatX>>(MatX(A));
  const auto pivots = factor->matrixLU().diagonal().array();
  if (!((pivots.abs() > 0).all() && pivots.isFinite().all())) return {};
  return [factor](const VecX& b) -> VecX { return factor->solve(b); };
}

}  // namespace aussois
