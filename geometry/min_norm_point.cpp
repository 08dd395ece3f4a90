// SPDX-License-Identifier: Apache-2.0
#include "geometry/min_norm_point.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

namespace aussois {
namespace {

constexpr double kWeight = 1e-9;  // convex weights below this are rounding and do not support

constexpr double kDependent = 1e-14;  // squared sine or volume of edges that count as dependent

using Weights = std::array<double, 4>;

// How far to go from the first of the points along the edges to the `n` - 1 others, to the affine point of
// minimal norm; false if the edges are dependent.
bool along_edges(const Vec3& a, const std::array<Vec3, 3>& edge, int n, Vec3& along) {
  const auto& [d, e, f] = edge;
  if (n == 2) {
    const double size = d.squaredNorm();
    if (!(size > 0)) return false;
    along[0] = -a.dot(d) / size;
    return true;
  }
  if (n == 3) {
    const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e), det = dd * ee - de * de;
    if (!(det > kDependent * dd * ee)) return false;
    const double ad = a.dot(d), ae = a.dot(e);
    along[0] = (ae * de - ad * ee) / det;
    along[1] = (ad * de - ae * dd) / det;
    return true;
  }
  const Vec3 across = e.cross(f);
  const double det = d.dot(across);  // the origin is in reach
  if (!(det * det > kDependent * d.squaredNorm() * e.squaredNorm() * f.squaredNorm())) return false;
  along = -Vec3(a.dot(across), a.dot(f.cross(d)), a.dot(d.cross(e))) / det;
  return true;
}

// Affine minimal-norm point of the first `n` <= 4 picked points; false if a weight is negative or the points
// are dependent.
bool affine_min_norm(const std::vector<Vec3>& g, const std::array<int, 4>& pick, int n, Weights& weight,
                     Vec3& point) {
  const Vec3& a = g[pick[0]];
  std::array<Vec3, 3> edge;
  for (int i = 1; i < n; ++i) edge[i - 1] = g[pick[i]] - a;
  Vec3 along = Vec3::Zero();
  if (n > 1 && !along_edges(a, edge, n, along)) return false;
  point = a;
  weight[0] = 1;
  bool inside = true;
  for (int i = 1; i < n; ++i) {
    weight[i] = along[i - 1];
    weight[0] -= weight[i];
    point += weight[i] * edge[i - 1];
    inside = inside && weight[i] >= 0;
  }
  return inside && weight[0] >= 0;
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
    Weights weight;
    Vec3 point;
    if (!affine_min_norm(g, pick, picked, weight, point) || point.norm() >= best_norm - 1e-15) continue;
    best_norm = point.norm();
    best.point = point;
    best.support.clear();
    for (int i = 0; i < picked; ++i)
      if (weight[i] > kWeight) best.support.push_back(pick[i]);
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
