// SPDX-License-Identifier: Apache-2.0
#include "nsgs/factorised.hpp"

#include <memory>

#include <Eigen/KLUSupport>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

namespace aussois {

namespace {

// Measured by bench_factorisation.
constexpr Eigen::Index kDenseSize = 40, kLargestDense = 300;
constexpr double kDenseShare = 0.25;  // of entries that are not zero

bool is_dense(const SparseMatrix& A) {
  const double n = double(A.rows());
  return A.rows() <= kDenseSize || (A.rows() <= kLargestDense && double(A.nonZeros()) > kDenseShare * n * n);
}

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
  if (!is_dense(A))
    return is_symmetric(A) ? solve_with<Eigen::SimplicialLDLT<SparseMatrix>>(A)
                           : solve_with<Eigen::KLU<SparseMatrix>>(A);
  const auto factor = std::make_shared<Eigen::PartialPivLU<MatX>>(MatX(A));
  const auto pivots = factor->matrixLU().diagonal().array();
  if (!((pivots.abs() > 0).all() && pivots.isFinite().all())) return {};
  return [factor](const VecX& b) -> VecX { return factor->solve(b); };
}

}  // namespace aussois
