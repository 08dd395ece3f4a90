// SPDX-License-Identifier: Apache-2.0
// Vectors of at most six entries as non-negative combinations of others: a small linear program (RED-12).
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Columns are generators, 1 to 6 rows.
using Generators = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6>;
using ShortVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6>;

/// The cheapest lambda >= 0 with G lambda = g, at a vertex: no more columns than rows have a weight.
struct Combination {
  bool exists = false;
  double cost = kInf;
  std::vector<int> column{};     // those with a weight, ascending
  std::vector<double> weight{};  // of them, > 0
  ShortVector dual{};            // y: y . g = cost and y . G_j <= cost_j; without a combination
                                 // y . g > 0 >= y . G_j
};

/// Costs must not be negative, so that the program is bounded. Numbers should be of the size 1: residuals and
/// reduced costs below 1e-10 of it count as zero. Revised simplex method in two phases; Bland's rule once the
/// fast one has not ended, so it always does.
Combination cheapest_combination(const Generators& G, const ShortVector& g, const VecX& cost);

}  // namespace aussois
