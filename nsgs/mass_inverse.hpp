// SPDX-License-Identifier: Apache-2.0
// M^-1 of a generalised mass matrix: inverses of the small blocks that free rigid bodies are, factors of the
// large ones that beams and solids are. M need not be symmetric.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct MassFactor;

/// Blocks that M does not couple with each other, ordered by their first row.
struct MassInverse {
  std::vector<int> rows{};        // block after block, ascending within each
  std::vector<int> first{0};      // where each block begins in `rows`; at the end one past the last
  std::vector<double> inverse{};  // inverses of the small blocks, column-major, one after the other
  std::vector<std::size_t> at{};  // where each begins in `inverse`; of a large one, where it would
  std::vector<int> block_of{};    // the block of every row
  // Of each block of more than kLargestMassBlock rows, null of the others; empty if there is none
  std::vector<std::shared_ptr<const MassFactor>> large{};

  int count() const { return int(at.size()); }
  int row(int block, int i) const { return rows[first[block] + i]; }
  int size(int block) const { return first[std::size_t(block) + 1] - first[block]; }
  const MassFactor* factor(int block) const { return large.empty() ? nullptr : large[block].get(); }
  VecX operator*(const VecX& x) const;
  SparseMatrix operator*(const SparseMatrix& X) const;
};

inline constexpr int kLargestMassBlock = 24;  // rows: four coupled rigid bodies; above, M^-1 H stops being
                                              // sparse

/// The inverse for some rows, ascending, which must make up whole blocks.
MassInverse inverse_part(const MassInverse& inverse, const std::vector<int>& some);

bool same_bits(const SparseMatrix& A, const SparseMatrix& B);  // both must be compressed

/// Empty if M is not finite, or singular to working precision.
std::optional<MassInverse> invert_mass(const SparseMatrix& M);
/// The same, bit for bit, but without inverting again the blocks that M shares with `last_M`, whose inverse
/// is `last`. Both matrices must be compressed.
std::optional<MassInverse> invert_mass(const SparseMatrix& M, const SparseMatrix& last_M,
                                       const MassInverse& last);

}  // namespace aussois
