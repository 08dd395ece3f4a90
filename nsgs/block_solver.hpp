// SPDX-License-Identifier: Apache-2.0
// Solves one block of rows with the others held: finds r with u = W r + q and the block's law (ONE-1) to
// (ONE-9). Works on scaled rows. Private to nsgs: sweeps call it once per block.
#pragma once

#include "nsgs/law.hpp"
#include "nsgs/one_contact.hpp"

namespace aussois {

template <int R>
struct BlockSolution {
  Rows<R> r{};
  bool solved = true, fail_safe = false;
};

/// What is known about a block before any sweep. R is one of the values that with_rows passes.
template <int R>
struct Block {
  RowBlock<R> W{}, inverse{};
  Rows<R> rho{};         // (ONE-3)
  double norm = 0;       // of W
  bool regular = false;  // `inverse` is valid
};

Block<1> prepare_block(const RowBlock<1>& W, const Law& law);
Block<2> prepare_block(const RowBlock<2>& W, const Law& law);
Block<3> prepare_block(const RowBlock<3>& W, const Law& law);
Block<5> prepare_block(const RowBlock<5>& W, const Law& law);
Block<Eigen::Dynamic> prepare_block(const AnyBlock& W, const Law& law);

/// Separation takes precedence over stick, and stick over slip. `solved` is false if no candidate meets
/// (ONE-6); r is then the best one.
BlockSolution<1> solve_block(const Block<1>& block, const Rows<1>& q, const Law& law, const Rows<1>& start,
                             LocalSolver solver);
BlockSolution<2> solve_block(const Block<2>& block, const Rows<2>& q, const Law& law, const Rows<2>& start,
                             LocalSolver solver);
BlockSolution<3> solve_block(const Block<3>& block, const Rows<3>& q, const Law& law, const Rows<3>& start,
                             LocalSolver solver);
BlockSolution<5> solve_block(const Block<5>& block, const Rows<5>& q, const Law& law, const Rows<5>& start,
                             LocalSolver solver);
BlockSolution<Eigen::Dynamic> solve_block(const Block<Eigen::Dynamic>& block, const AnyRows& q,
                                          const Law& law, const AnyRows& start, LocalSolver solver);

}  // namespace aussois
