// SPDX-License-Identifier: Apache-2.0
// One block of rows, the others held: find r with u = W r + q and the block's law (ONE-1) to (ONE-9). In
// scaled rows. Private to nsgs: sweeps call it once per block.
#pragma once

#include "nsgs/law.hpp"
#include "nsgs/one_contact.hpp"

namespace aussois {

/// What is known of a block before any sweep.
template <int R>
struct Block {
  RowBlock<R> W{}, inverse{};
  Rows<R> rho{};         // (ONE-3)
  double norm = 0;       // of W
  bool regular = false;  // the inverse is one
};

template <int R>
Block<R> prepare_block(const RowBlock<R>& W, const Law& law);

template <int R>
struct BlockSolution {
  Rows<R> r{};
  bool solved = true, fail_safe = false;
};

/// Separation goes before stick and stick before slip. `solved` is false if no candidate meets (ONE-6); r is
/// then the best one.
template <int R>
BlockSolution<R> solve_block(const Block<R>& block, const Rows<R>& q, const Law& law, const Rows<R>& start,
                             LocalSolver solver);

}  // namespace aussois
