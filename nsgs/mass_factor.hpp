// SPDX-License-Identifier: Apache-2.0
// LU of a large block of a generalised mass matrix, six rows at a time: linear in the length of cables and
// chains. Private to nsgs.
#pragma once

#include <memory>
#include <span>

#include <Eigen/SparseLU>

#include "nsgs/body_lu.hpp"

namespace aussois {

/// Rows and columns are scaled by the diagonal: kg beside kg m^2 is not ill-conditioning.
struct MassFactor {
  VecX scale{};
  BodyLu lu;
  // Instead, with pivots from any row, where LU by bodies loses digits
  std::unique_ptr<Eigen::SparseLU<SparseMatrix>> pivoted{};
};

/// Of the rows `rows` of M, ascending, that M couples with each other only. `like` is the factor of another
/// matrix with the same pattern, or null. Null if the block is singular to working precision.
std::shared_ptr<const MassFactor> mass_factor(const SparseMatrix& M, std::span<const int> rows,
                                              const MassFactor* like = nullptr);
VecX solve(const MassFactor& factor, const VecX& x);

}  // namespace aussois
