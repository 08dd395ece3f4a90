// SPDX-License-Identifier: Apache-2.0
#include "geometry/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "geometry/check.hpp"

namespace aussois {
namespace {

double squared_distance(const Box& box, const Vec3& p) {
  return (p - p.cwiseMax(box.lo).cwiseMin(box.hi)).squaredNorm();
}

// Nearest point of a triangle with the face of it that carries the point [Ericson2005, 5.1.5]: weights of the
// corners, those of the other corners zero.
Vec3 nearest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {1 - (vb + vc) / sum, vb / sum, vc / sum};
}

bool meets(const Box& box, const Vec3& origin, const Vec3& inverse, double to) {
  const Vec3 a = (box.lo - origin).cwiseProduct(inverse), b = (box.hi - origin).cwiseProduct(inverse);
  const double enter = a.cwiseMin(b).maxCoeff(), leave = a.cwiseMax(b).minCoeff();
  return leave >= 0 && enter <= leave && enter <= to;
}

constexpr int kLeaf = 4;

}  // namespace

SurfaceTree::SurfaceTree(const SimplicialComplex& complex) : complex_(complex) {
  require(!complex.triangles.empty(), "SurfaceTree: the complex must have triangles");
  const std::size_t n = complex.triangles.size();
  std::vector<Box> boxes(n);
  std::vector<Vec3> centres(n, Vec3::Zero());
  normal_.assign(n, Vec3::Zero());
  vertex_normal_.assign(complex.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < n; ++t) {
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = complex.vertices[complex.triangles[t][k]];
      boxes[t].lo = boxes[t].lo.cwiseMin(x[k]);
      boxes[t].hi = boxes[t].hi.cwiseMax(x[k]);
    }
    centres[t] = 0.5 * (boxes[t].lo + boxes[t].hi);
    normal_[t] = (x[1] - x[0]).cross(x[2] - x[0]).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 d = x[(k + 1) % 3] - x[k], e = x[(k + 2) % 3] - x[k];
      vertex_normal_[complex.triangles[t][k]] += std::atan2(d.cross(e).norm(), d.dot(e)) * normal_[t];
    }
  }
  items_.resize(n);
  std::iota(items_.begin(), items_.end(), 0);
  build(0, int(n), boxes, centres);
}

int SurfaceTree::build(int begin, int end, const std::vector<Box>& boxes, const std::vector<Vec3>& centres) {
  Node made{{}, begin, end};
  for (int k = begin; k < end; ++k) {
    const Box& box = boxes[items_[k]];
    made.box.lo = made.box.lo.cwiseMin(box.lo);
    made.box.hi = made.box.hi.cwiseMax(box.hi);
  }
  const int index = int(nodes_.size());
  nodes_.push_back(made);
  if (end - begin <= kLeaf) return index;
  Eigen::Index axis = 0;
  (made.box.hi - made.box.lo).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end, [&](int i, int j) {
    const double x = centres[i][axis], y = centres[j][axis];
    return x != y ? x < y : i < j;
  });
  const int left = build(begin, middle, boxes, centres), right = build(middle, end, boxes, centres);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

SurfacePoint SurfaceTree::nearest(const Vec3& p) const {
  SurfacePoint best;
  Vec3 weights = Vec3::Zero();
  double best2 = kInf;
  std::vector<std::pair<double, int>> stack = {{squared_distance(nodes_[0].box, p), 0}};
  while (!stack.empty()) {
    const auto [lower, index] = stack.back();
    stack.pop_back();
    if (lower >= best2) continue;
    const Node& node = nodes_[index];
    if (node.left >= 0) {
      std::pair<double, int> near{squared_distance(nodes_[node.left].box, p), node.left},
          far{squared_distance(nodes_[node.right].box, p), node.right};
      if (far.first < near.first) std::swap(near, far);
      stack.push_back(far);
      stack.push_back(near);
      continue;
    }
    for (int k = node.begin; k < node.end; ++k) {
      const int t = items_[k];
      const auto& [i, j, l] = complex_.triangles[t];
      const Vec3 &a = complex_.vertices[i], &b = complex_.vertices[j], &c = complex_.vertices[l];
      const Vec3 w = nearest_weights(p, a, b, c);
      const Vec3 x = w[0] * a + w[1] * b + w[2] * c;
      const double d2 = (x - p).squaredNorm();
      if (d2 < best2) best2 = d2, best.triangle = t, best.x = x, weights = w;
    }
  }
  best.distance = std::sqrt(best2);
  const auto t = std::size_t(best.triangle);
  const int zeros = int((weights.array() == 0).count());
  best.dim = 2 - zeros;
  best.simplex = best.triangle;
  for (std::size_t k = 0; k < 3 && zeros > 0; ++k) {
    if (zeros == 2 && weights[Eigen::Index(k)] != 0) best.simplex = complex_.triangles[t][k];
    if (zeros == 1 && weights[Eigen::Index(k)] == 0)
      best.simplex = complex_.triangle_edges[t][(k + 1) % 3];  // opposite to the corner without weight
  }
  return best;
}

double SurfaceTree::signed_distance(const Vec3& p, const SurfacePoint& foot) const {
  Vec3 n = normal_[foot.triangle];
  if (foot.dim == 0) n = vertex_normal_[foot.simplex];
  if (foot.dim == 1) {
    n = Vec3::Zero();
    for (int t : complex_.edge_triangles[foot.simplex]) n += normal_[t];
  }
  return (p - foot.x).dot(n) < 0 ? -foot.distance : foot.distance;
}

std::optional<double> SurfaceTree::first_exit(const Vec3& origin, const Vec3& direction, double from,
                                              double least_cosine) const {
  double to = kInf;
  Vec3 inverse = direction;  // not infinite: 0 times infinity would be no number
  for (double& d : inverse) d = 1 / (d == 0 ? 1e-290 : d);
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (!meets(node.box, origin, inverse, to)) continue;
    if (node.left >= 0) {
      stack.insert(stack.end(), {node.right, node.left});
      continue;
    }
    for (int k = node.begin; k < node.end; ++k) {
      const int t = items_[k];
      const Vec3& n = normal(t);
      const double slope = n.dot(direction);
      if (slope <= least_cosine) continue;
      const auto& corners = complex_.triangles[t];
      std::array<Vec3, 3> x;
      for (std::size_t i = 0; i < 3; ++i) x[i] = complex_.vertices[corners[i]];
      const double length = n.dot(x[0] - origin) / slope;
      if (!(length > from) || length >= to) continue;
      const Vec3 hit = origin + length * direction;
      bool inside = true;
      for (std::size_t i = 0; i < 3 && inside; ++i)
        inside = n.dot((x[(i + 1) % 3] - x[i]).cross(hit - x[i])) >= 0;
      if (inside) to = length;
    }
  }
  return to < kInf ? std::optional(to) : std::nullopt;
}

}  // namespace aussois
