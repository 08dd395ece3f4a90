// SPDX-License-Identifier: Apache-2.0
#include "nsgs/anderson.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

namespace aussois {

VecX Anderson::propose(const VecX& x, const VecX& g) {
  if (memory_ == 0) return {};
  const auto m = Eigen::Index(memory_);
  const VecX f = g - x;
  if (f_.size() == 0) {
    df_.resize(f.size(), m), dg_.resize(f.size(), m), gram_.setZero(m, m);
  } else {
    const auto k = Eigen::Index(steps_++ % memory_), filled = Eigen::Index(std::min(steps_, memory_));
    df_.col(k) = f - f_;
    dg_.col(k) = g - g_;
    for (Eigen::Index j = 0; j < filled; ++j) gram_(j, k) = gram_(k, j) = df_.col(j).dot(df_.col(k));
  }
  f_ = f;
  g_ = g;
  const auto filled = Eigen::Index(std::min(steps_, memory_));
  if (filled == 0) return {};
  const VecX s = gram_.diagonal().head(filled).cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  MatX A = s.asDiagonal() * gram_.topLeftCorner(filled, filled) * s.asDiagonal();
  A.diagonal().array() += 1e-13;
  const VecX rhs = s.cwiseProduct(df_.leftCols(filled).transpose() * f);
  const VecX gamma = s.cwiseProduct(A.ldlt().solve(rhs));
  VecX proposed = g;
  proposed.noalias() -= dg_.leftCols(filled) * gamma;
  return proposed.allFinite() ? proposed : VecX();
}

}  // namespace aussois
