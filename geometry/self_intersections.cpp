// SPDX-License-Identifier: Apache-2.0
#include "geometry/self_intersections.hpp"

#include <algorithm>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "geometry/mesh_report.hpp"

namespace aussois {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle = Kernel::Triangle_3;

bool overlap(const Box& a, const Box& b) {
  return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all();
}

Box united(const Box& a, const Box& b) {
  return {a.lo.cwiseMin(b.lo), a.hi.cwiseMax(b.hi)};
}

struct Corners {
  std::array<int, 3> place{};  // equal numbers: equal places
  std::array<Point, 3> point{};
};

// Elsewhere than in what they share; the cases are those of CGAL's PMP::self_intersections.
bool meet(const Corners& s, const Corners& t) {
  std::array<std::size_t, 3> in_s{}, in_t{};  // shared corners first, then the others
  std::size_t shared = 0, rest_s = 3;
  std::array<bool, 3> used_t{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto j = std::size_t(std::find(t.place.begin(), t.place.end(), s.place[i]) - t.place.begin());
    if (j == 3) {
      in_s[--rest_s] = i;
    } else {
      in_s[shared] = i, in_t[shared] = j, used_t[j] = true;
      ++shared;
    }
  }
  std::size_t next = shared;
  for (std::size_t j = 0; j < 3; ++j)
    if (!used_t[j]) in_t[next++] = j;
  const auto p = [&](std::size_t k) -> const Point& { return s.point[in_s[k]]; };
  const auto q = [&](std::size_t k) -> const Point& { return t.point[in_t[k]]; };

  if (shared == 3) return true;
  if (shared == 2)  // folded flat onto each other
    return CGAL::coplanar(p(0), p(1), p(2), q(2)) &&
           CGAL::coplanar_orientation(p(0), p(1), p(2), q(2)) == CGAL::POSITIVE;
  const Triangle triangle_s(p(0), p(1), p(2)), triangle_t(q(0), q(1), q(2));
  if (shared == 1)  // the side opposite to the shared corner
    return CGAL::do_intersect(triangle_s, Segment(q(1), q(2))) ||
           CGAL::do_intersect(triangle_t, Segment(p(1), p(2)));
  return CGAL::do_intersect(triangle_s, triangle_t);
}

// A binary tree of boxes over the triangles, halved at the median of the longest side.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes, std::vector<int> items)
      : boxes_(std::move(boxes)), items_(std::move(items)) {
    if (!items_.empty()) build(0, int(items_.size()));
  }

  /// Calls f(i, j) for all pairs of items whose boxes overlap until f returns false.
  template <class F>
  void for_each_pair(const F& f) const {
    if (nodes_.empty()) return;
    std::vector<std::array<int, 2>> stack = {{0, 0}};
    while (!stack.empty()) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      const Node &m = node(a), &n = node(b);
      if (a != b && !overlap(m.box, n.box)) continue;
      if (m.left < 0 && n.left < 0) {
        if (!pairs_of_leaves(m, n, f)) return;
      } else if (a == b) {
        stack.insert(stack.end(), {{m.left, m.left}, {m.left, m.right}, {m.right, m.right}});
      } else if (n.left < 0 || (m.left >= 0 && m.end - m.begin >= n.end - n.begin)) {
        stack.insert(stack.end(), {{m.left, b}, {m.right, b}});
      } else {
        stack.insert(stack.end(), {{a, n.left}, {a, n.right}});
      }
    }
  }

 private:
  struct Node {
    Box box{};
    int begin = 0, end = 0;     // of items_
    int left = -1, right = -1;  // nodes; -1: a leaf
  };
  static constexpr int kLeaf = 4;

  const Node& node(int i) const { return nodes_[std::size_t(i)]; }
  const Box& box(int item) const { return boxes_[std::size_t(item)]; }

  int build(int begin, int end) {
    Node made{{}, begin, end};
    for (int k = begin; k < end; ++k) made.box = united(made.box, box(items_[std::size_t(k)]));
    const int index = int(nodes_.size());
    nodes_.push_back(made);
    if (end - begin <= kLeaf) return index;
    Eigen::Index axis = 0;
    (made.box.hi - made.box.lo).maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(
        items_.begin() + begin, items_.begin() + middle, items_.begin() + end, [&](int i, int j) {
          const double x = box(i).lo[axis] + box(i).hi[axis], y = box(j).lo[axis] + box(j).hi[axis];
          return x != y ? x < y : i < j;
        });
    const int left = build(begin, middle);
    const int right = build(middle, end);
    nodes_[std::size_t(index)].left = left;
    nodes_[std::size_t(index)].right = right;
    return index;
  }

  template <class F>
  bool pairs_of_leaves(const Node& m, const Node& n, const F& f) const {
    for (int k = m.begin; k < m.end; ++k)
      for (int l = &m == &n ? k + 1 : n.begin; l < n.end; ++l) {
        const int i = items_[std::size_t(k)], j = items_[std::size_t(l)];
        if (overlap(box(i), box(j)) && !f(std::min(i, j), std::max(i, j))) return false;
      }
    return true;
  }

  std::vector<Box> boxes_;
  std::vector<int> items_;
  std::vector<Node> nodes_{};
};

}  // namespace

std::vector<std::array<int, 2>> self_intersections(const SimplicialComplex& complex, std::size_t limit) {
  const std::vector<int> place = first_at_same_place(complex.vertices);
  std::vector<Corners> corners(complex.triangles.size());
  std::vector<Box> boxes(complex.triangles.size());
  std::vector<int> with_area;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = std::size_t(complex.triangles[t][k]);
      const Vec3& x = complex.vertices[vertex];
      corners[t].place[k] = place[vertex];
      corners[t].point[k] = Point(x.x(), x.y(), x.z());
      boxes[t] = united(boxes[t], {x, x});
    }
    const auto& [a, b, c] = corners[t].point;
    if (!CGAL::collinear(a, b, c)) with_area.push_back(int(t));
  }

  std::vector<std::array<int, 2>> pairs;
  BoxTree(std::move(boxes), std::move(with_area)).for_each_pair([&](int i, int j) {
    if (pairs.size() < limit && meet(corners[std::size_t(i)], corners[std::size_t(j)]))
      pairs.push_back({i, j});
    return pairs.size() < limit;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace aussois
