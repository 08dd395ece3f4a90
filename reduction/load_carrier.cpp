// SPDX-License-Identifier: Apache-2.0
#include "reduction/load_carrier.hpp"

#include <algorithm>

#include "reduction/hull_exact.hpp"
#include "reduction/linear_program.hpp"

namespace aussois {
namespace {

constexpr double kCarries = 1e-6;  // of the patch's load: less is the solver's tolerance, not a carrier

}  // namespace

std::vector<int> load_carrier(const PlanarPatch& patch, std::span<const double> load) {
  double sum = 0;
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 0; i < load.size(); ++i) {
    sum += std::max(load[i], 0.0);
    moment += std::max(load[i], 0.0) * patch.x[i];
  }
  if (!(sum > 0) || !(patch.extent > 0)) return hull_exact(patch);
  std::vector<int> carriers;
  for (std::size_t i = 0; i < load.size(); ++i)
    if (load[i] > kCarries * sum) carriers.push_back(int(i));
  const bool at_corners = std::ranges::all_of(
      carriers, [&](int i) { return std::ranges::find(patch.hull, i) != patch.hull.end(); });
  if (carriers.size() <= 3 && at_corners) return carriers;

  // lambda >= 0 with sum lambda = 1, sum lambda x = centre of pressure, the largest sum of lambda |x|^2: the
  // triangle of the farthest-point Delaunay triangulation
  const Vec2 centre = moment / sum / patch.extent;
  Generators G(3, Eigen::Index(patch.hull.size()));
  VecX cost(G.cols());
  for (Eigen::Index k = 0; k < G.cols(); ++k) {
    const Vec2 x = patch.x[patch.hull[k]] / patch.extent - centre;
    G.col(k) << 1, x;
    cost[k] = -x.squaredNorm();
  }
  cost.array() -= cost.minCoeff();  // the sum of lambda is given
  const Combination found = cheapest_combination(G, Vec3(1, 0, 0), cost);
  if (!found.exists) return hull_exact(patch);
  std::vector<int> result;
  for (const int k : found.column) result.push_back(patch.hull[k]);
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace aussois
