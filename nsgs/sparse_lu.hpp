// SPDX-License-Identifier: Apache-2.0
// Solves J x = b for Newton's matrices, which are unsymmetric but have a symmetric pattern: dense if small,
// KLU if larger (measured in doc/theory/proximal_newton.md). Private to nsgs.
#pragma once

#include <functional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Compressed columns, rows ascending within each.
struct CompressedColumns {
  std::vector<int> begin{0}, row{};
  std::vector<double> value{};
  int size() const { return int(begin.size()) - 1; }
};

CompressedColumns compressed(const SparseMatrix& A);

/// An order of the nodes of a graph, given in compressed rows, in which a factorisation causes little
/// fill-in. Every node must be its own neighbour; nodes that are not count as dense.
std::vector<int> fill_reducing_order(const std::vector<int>& begin, const std::vector<int>& other);

/// Approximate number of multiplications and additions of a factorisation, from the pattern alone.
double factor_cost(CompressedColumns& J);

/// J^-1, with J factorised in its own order; pivots leave the diagonal where they must. Empty if J is
/// singular to working precision.
std::function<VecX(const VecX&)> inverse_of(CompressedColumns J);

}  // namespace aussois
