// SPDX-License-Identifier: Apache-2.0
// J x = b for the unsymmetric matrices of Newton, whose pattern is symmetric: dense where small, KLU with AMD
// ordering above (measured in doc/theory/proximal_newton.md). Private to nsgs.
#pragma once

#include <optional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Compressed columns, rows ascending within each.
struct CompressedColumns {
  std::vector<int> begin{0}, row{};
  std::vector<double> value{};
  int size() const { return int(begin.size()) - 1; }
};

/// Multiplications and additions of a factorisation, about; from the pattern alone.
double factor_cost(CompressedColumns& J);

/// Nothing if J is singular to working precision.
std::optional<VecX> solve_once(CompressedColumns& J, const VecX& b);

}  // namespace aussois
