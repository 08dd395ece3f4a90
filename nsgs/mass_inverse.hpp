// SPDX-License-Identifier: Apache-2.0
// M^-1 of a generalised mass matrix: small inverses where M is block diagonal (free rigid bodies), sparse LU
// where it is not. M need not be symmetric.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// One block that M does not couple with the rest.
struct MassBlock {
  std::vector<int> rows{};  // ascending
  MatX inverse{};
};

struct SparseFactor;  // Eigen's SparseLU, kept out of this header

struct MassInverse {
  std::vector<MassBlock> blocks{};         // ordered by their first row; empty if `factor` is set
  std::vector<int> block_of{};             // the block of every row
  std::shared_ptr<SparseFactor> factor{};  // for a matrix with a block of more than kLargestMassBlock rows

  VecX operator*(const VecX& x) const;
  SparseMatrix operator*(const SparseMatrix& X) const;
};

inline constexpr int kLargestMassBlock = 24;  // four coupled rigid bodies; above, M^-1 H stops being sparse

/// Nothing if M is not finite, or singular to working precision.
std::optional<MassInverse> invert_mass(const SparseMatrix& M);

}  // namespace aussois
