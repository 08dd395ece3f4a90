// SPDX-License-Identifier: Apache-2.0
// A small linear program: vectors of at most six entries as non-negative combinations of others (RED-12).
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Columns are generators, 1 to 6 rows.
using Generators = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6>;
using ShortVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6>;

/// The cheapest lambda >= 0 with G lambda = g, at a vertex: at most as many columns have a weight as there
/// are rows.
struct Combination {
  bool exists = false;
  double cost = kInf;
  std::vector<int> column{};     // columns with a weight, ascending
  std::vector<double> weight{};  // their weights, > 0
  ShortVector dual{};            // y: y . g = cost and y . G_j <= cost_j; without a combination
                                 // y . g > 0 >= y . G_j
};

/// Costs must not be negative, so that the program is bounded. Numbers should be of order 1: residuals and
/// reduced costs below 1e-10 count as zero. Revised simplex method in two phases. If the fast pivot rule does
/// not end, Bland's rule takes over, so the method always ends.
Combination cheapest_combination(const Generators& G, const ShortVector& g, const VecX& cost);

}  // namespace aussois
