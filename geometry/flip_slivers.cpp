// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include <Eigen/Geometry>

#include "geometry/repair_steps.hpp"

namespace aussois {
namespace {

using Edge = std::array<int, 2>;
using Triangle = std::array<int, 3>;

Edge edge_of(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

Triangle replaced(Triangle triangle, int old_corner, int new_corner) {
  std::ranges::replace(triangle, old_corner, new_corner);
  return triangle;
}

class SliverFlips {
 public:
  SliverFlips(const SimplicialComplex& complex, double tolerance)
      : vertices_(complex.vertices),
        tolerance_(tolerance),
        triangles_(complex.triangles.to_vector()),
        dropped_(complex.triangles.size()),
        proper_(complex.vertices.size()) {
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (is_sliver(triangles_[t])) waiting_.insert(int(t));
    if (waiting_.empty()) return;
    for (const Triangle& corners : triangles_) count(corners, 1);
    for (std::size_t e = 0; e < complex.edges.size(); ++e) {
      const std::span<const int> around = complex.edge_triangles[int(e)];
      if (!around.empty())
        around_.emplace_hint(around_.end(), complex.edges[e], Around(around.begin(), around.end()));
    }
  }

  // No flipped edge returns, so this ends.
  void run() {
    while (!waiting_.empty()) {
      const int t = *waiting_.begin();
      waiting_.erase(waiting_.begin());
      if (!dropped_[t] && is_sliver(triangle(t))) mend(t);
    }
  }

  FlippedComplex result(const SimplicialComplex& complex) const {
    FlippedComplex out{{}, done_, border_, 0};
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (dropped_[t]) continue;
      kept.push_back(triangles_[t]);
      out.left += is_sliver(triangles_[t]);
    }
    const bool same = done_.count + border_.count == 0;
    out.complex = same ? complex : make_complex(vertices_, std::move(kept), wires_of(complex));
    return out;
  }

 private:
  using Around = std::vector<int>;

  const Vec3& x(int vertex) const { return vertices_[vertex]; }
  const Triangle& triangle(int t) const { return triangles_[t]; }
  double height(const Triangle& t) const { return triangle_height(x(t[0]), x(t[1]), x(t[2])); }
  bool is_sliver(const Triangle& t) const { return height(t) <= tolerance_; }
  Vec3 normal(const Triangle& t) const { return (x(t[1]) - x(t[0])).cross(x(t[2]) - x(t[0])); }
  double length(int a, int b) const { return (x(b) - x(a)).norm(); }

  void mend(int t) {
    const Triangle sliver = triangle(t);
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (length(sliver[i], sliver[(i + 1) % 3]) > length(sliver[k], sliver[(k + 1) % 3])) k = i;
    const int a = sliver[k], b = sliver[(k + 1) % 3], v = sliver[(k + 2) % 3];
    const Around& around = around_.at(edge_of(a, b));
    if (around.size() == 2 && flip(t, around[0] == t ? around[1] : around[0], a, b, v)) return;
    if (is_open(a, b) || is_open(b, v) || is_open(v, a)) drop_at_border(t, v);
  }

  // Modulo two, as in (CPX-10).
  bool is_open(int a, int b) const { return around_.at(edge_of(a, b)).size() % 2 == 1; }

  // Its corners belong to triangles with area, which have its shape too; T-junctions that it leaves are split
  // later.
  void drop_at_border(int t, int v) {
    const Triangle sliver = triangle(t);
    if (std::ranges::any_of(sliver, [&](int corner) { return proper_[corner] == 0; })) return;
    border_.add(x(v), height(sliver));
    detach(t);
    dropped_[t] = true;
    for (std::size_t i = 0; i < 3; ++i) wake(edge_of(sliver[i], sliver[(i + 1) % 3]));
  }

  // (a, b, v) and `other` = (b, a, c) become (a, v, c) and (v, b, c), wound like `other` (CPX-8).
  bool flip(int t, int other, int a, int b, int v) {
    int c = -1;
    for (const int corner : triangle(other))
      if (corner != a && corner != b) c = corner;
    const Triangle first = replaced(triangle(other), b, v), second = replaced(triangle(other), a, v);
    if (c == v || around_.contains(edge_of(v, c)) || flipped_away_.contains(edge_of(v, c))) return false;
    if (!improves(triangle(t), triangle(other), first, second, length(v, c) < length(a, b))) return false;
    done_.add(x(v), height(triangle(t)));
    flipped_away_.insert(edge_of(a, b));
    detach(t);
    detach(other);
    attach(t, first);
    attach(other, second);
    for (const int part : {t, other})
      for (std::size_t i = 0; i < 3; ++i) wake(edge_of(triangle(part)[i], triangle(part)[(i + 1) % 3]));
    return true;
  }

  // (CPX-9): two slivers trade a long edge for a shorter one, a sliver and a proper triangle become two
  // better ones that face as the proper one did.
  bool improves(const Triangle& sliver, const Triangle& other, const Triangle& first, const Triangle& second,
                bool shorter) const {
    if (is_sliver(other)) return shorter;
    return std::min(height(first), height(second)) > height(sliver) && normal(first).dot(normal(other)) > 0 &&
           normal(second).dot(normal(other)) > 0;
  }

  void attach(int t, const Triangle& corners) {
    triangles_[t] = corners;
    for (std::size_t i = 0; i < 3; ++i) around_[edge_of(corners[i], corners[(i + 1) % 3])].push_back(t);
    count(corners, 1);
  }
  void detach(int t) {
    const Triangle& corners = triangle(t);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto place = around_.find(edge_of(corners[i], corners[(i + 1) % 3]));
      std::erase(place->second, t);
      if (place->second.empty()) around_.erase(place);
    }
    count(corners, -1);
  }
  void count(const Triangle& corners, int change) {
    if (is_sliver(corners)) return;
    for (const int corner : corners) proper_[corner] += change;
  }
  void wake(const Edge& edge) {
    const auto place = around_.find(edge);
    if (place == around_.end()) return;
    for (const int t : place->second)
      if (is_sliver(triangle(t))) waiting_.insert(t);
  }

  SharedArray<Vec3> vertices_;
  double tolerance_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<bool> dropped_;
  std::vector<int> proper_;  // triangles with area at each vertex
  std::map<Edge, Around> around_{};
  std::set<int> waiting_{};
  std::set<Edge> flipped_away_{};
  RepairStep done_{}, border_{};
};

}  // namespace

FlippedComplex flip_slivers(const SimplicialComplex& complex, double tolerance) {
  SliverFlips flips(complex, tolerance);
  flips.run();
  return flips.result(complex);
}

}  // namespace aussois
