// SPDX-License-Identifier: Apache-2.0
// J x = b for the unsymmetric matrices of Newton, whose pattern is symmetric: dense where small, KLU above
// (measured in doc/theory/proximal_newton.md). Private to nsgs.
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

/// An order of the nodes of a graph in compressed rows in which a factorisation fills in little. Every node
/// must be its own neighbour: those that are not count as dense.
std::vector<int> fill_reducing_order(const std::vector<int>& begin, const std::vector<int>& other);

/// Multiplications and additions of a factorisation, about; from the pattern alone.
double factor_cost(CompressedColumns& J);

/// J^-1 in the order of J; pivots leave the diagonal where they must. Empty if J is singular to working
/// precision.
std::function<VecX(const VecX&)> inverse_of(CompressedColumns J);

}  // namespace aussois
