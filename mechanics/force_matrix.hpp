// SPDX-License-Identifier: Apache-2.0
// Derivatives of the forces of many elements: square blocks between bodies, or between points, where a
// pattern that is made once has them.
#pragma once

#include <memory>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct Layout;

/// Which block rows a law couples. Numbers are stored by columns, as the rows of each column ascend.
struct BlockPattern {
  int size = 0;                      // rows of a block: 6 of bodies, 3 of points
  std::vector<int> entry{};          // first entry of each block row in State::v, from ForceMatrix::first on;
                                     // ascending
  std::vector<int> begin{0}, row{};  // block rows of each block column, ascending

  std::size_t values() const { return row.size() * std::size_t(size * size); }
};
/// Each element couples all the block rows that it lists with each other.
std::shared_ptr<const BlockPattern> block_pattern(int size, std::vector<int> entry,
                                                  const std::vector<std::vector<int>>& elements);
/// The place in BlockPattern::row of a block that the pattern has.
int block_at(const BlockPattern& pattern, int row, int column);

/// -df/dq and -df/dv of a law, as of GeneralisedForce.
struct ForceMatrix {
  std::shared_ptr<const BlockPattern> pattern{};
  int first = 0;                 // entry of State::v that the pattern counts from
  std::vector<double> K{}, C{};  // pattern->values() each; C may be empty: zero
};

/// Adds N x N numbers to the block at `at` (block_at) in block column `column`.
template <int N, class Block>
void add_to_block(const BlockPattern& pattern, int at, int column, const Block& block,
                  std::vector<double>& values) {
  const int begin = pattern.begin[column], height = pattern.begin[std::size_t(column) + 1] - begin;
  double* const corner = values.data() + std::size_t(N) * (std::size_t(N) * begin + std::size_t(at - begin));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) corner[std::size_t(j) * N * height + i] += block(i, j);
}

/// Throws std::invalid_argument unless sizes fit each other and State::v of `velocities` entries.
void validate(const ForceMatrix& matrix, int velocities);

/// K dq + C dv of all matrices, laid out as State::v.
VecX force_change(const std::vector<ForceMatrix>& matrices, const VecX& dq, const VecX& dv);
/// of_K K + of_C C of all matrices, between the rows of the problem; zero where an axis is held.
SparseMatrix free_matrix(const std::vector<ForceMatrix>& matrices, double of_K, double of_C,
                         const Layout& dofs);

}  // namespace aussois
