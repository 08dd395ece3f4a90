// SPDX-License-Identifier: Apache-2.0
#include "geometry/min_norm_point.hpp"

#include <algorithm>
#include <array>

#include <Eigen/LU>

namespace aussois {
namespace {

constexpr double kWeight = 1e-9;  // convex weights below this are rounding and do not support

// Up to five numbers, without memory of their own.
using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1>;
using SmallSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 5, 5>;

// Affine minimal-norm point of the first `n` <= 4 picked points; false if a weight is negative or the points
// are dependent.
bool affine_min_norm(const std::vector<Vec3>& g, const std::array<int, 4>& pick, int n, Small& weight,
                     Vec3& point) {
  const auto at = [&](int i) -> const Vec3& { return g[pick[i]]; };
  if (n == 1) {
    weight = Small::Ones(1);
    point = at(0);
    return true;
  }
  SmallSquare A = SmallSquare::Zero(n + 1, n + 1);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A(i, j) = at(i).dot(at(j));
    A(i, n) = A(n, i) = 1;
  }
  Small rhs = Small::Zero(n + 1);
  rhs(n) = 1;
  const Eigen::FullPivLU<SmallSquare> lu(A);
  if (lu.rank() <= n) return false;
  weight = lu.solve(rhs).head(n);
  point = Vec3::Zero();
  for (int i = 0; i < n; ++i) point += weight(i) * at(i);
  return weight.minCoeff() >= 0;
}

// Smallest point of the hull of a small subset, by looking at all its faces.
MinNorm min_norm_of_subset(const std::vector<Vec3>& g, const std::vector<int>& subset) {
  MinNorm best;
  double best_norm = kInf;
  const int n = int(subset.size());
  for (int mask = 1; mask < (1 << n); ++mask) {
    std::array<int, 4> pick{};
    int picked = 0;
    for (int i = 0; i < n && picked <= 4; ++i)
      if (mask & (1 << i)) {
        if (picked < 4) pick[picked] = subset[i];
        ++picked;
      }
    if (picked > 4) continue;
    Small weight;
    Vec3 point;
    if (!affine_min_norm(g, pick, picked, weight, point) || point.norm() >= best_norm - 1e-15) continue;
    best_norm = point.norm();
    best.point = point;
    best.support.clear();
    for (int i = 0; i < picked; ++i)
      if (weight(i) > kWeight) best.support.push_back(pick[i]);
  }
  return best;
}

}  // namespace

MinNorm min_norm_point(const std::vector<Vec3>& g) {
  MinNorm best = min_norm_of_subset(g, {0});
  for (std::size_t round = 0; round < 8 * g.size() + 8; ++round) {
    int next = 0;
    for (int i = 1; i < int(g.size()); ++i)
      if (best.point.dot(g[i]) < best.point.dot(g[next])) next = i;
    if (best.point.norm() <= kHullContainsOrigin) break;
    const double gain = best.point.squaredNorm() - best.point.dot(g[next]);
    if (gain <= 1e-14 || std::ranges::count(best.support, next)) break;
    std::vector<int> subset = best.support;
    subset.push_back(next);
    const MinNorm better = min_norm_of_subset(g, subset);
    if (better.point.norm() >= best.point.norm()) break;
    best = better;
  }
  return best;
}

}  // namespace aussois
