// SPDX-License-Identifier: Apache-2.0
// Finds the boxes that overlap each other or anything else: for preparing meshes, not for their contacts.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

inline bool overlap(const Box& a, const Box& b) {
  return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all();
}

inline Box bounding_box(const Box& a, const Box& b) {
  return {a.lo.cwiseMin(b.lo), a.hi.cwiseMax(b.hi)};
}

/// A binary tree over the boxes of `items` (indices into `boxes`), halved at the median of the longest side;
/// O(n log n), the same for the same input.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes, std::vector<int> items)
      : boxes_(std::move(boxes)), items_(std::move(items)) {
    if (!items_.empty()) build(0, int(items_.size()));
  }

  /// Calls f(i, j) for all pairs of items whose boxes overlap, until f returns false.
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

  /// Calls f(i) for each item whose own box and all boxes above it satisfy `may_hold(box)`.
  template <class Test, class F>
  void for_each(const Test& may_hold, const F& f) const {
    std::vector<int> stack;
    if (!nodes_.empty()) stack.push_back(0);
    while (!stack.empty()) {
      const Node& n = node(stack.back());
      stack.pop_back();
      if (!may_hold(n.box)) continue;
      if (n.left >= 0) {
        stack.insert(stack.end(), {n.left, n.right});
        continue;
      }
      for (int k = n.begin; k < n.end; ++k)
        if (may_hold(box(items_[k]))) f(items_[k]);
    }
  }

 private:
  struct Node {
    Box box{};
    int begin = 0, end = 0;     // range in items_
    int left = -1, right = -1;  // nodes; -1: a leaf
  };
  static constexpr int kLeaf = 4;

  const Node& node(int i) const { return nodes_[i]; }
  const Box& box(int item) const { return boxes_[item]; }

  int build(int begin, int end) {
    Node made{{}, begin, end};
    for (int k = begin; k < end; ++k) made.box = bounding_box(made.box, box(items_[k]));
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
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
  }

  template <class F>
  bool pairs_of_leaves(const Node& m, const Node& n, const F& f) const {
    for (int k = m.begin; k < m.end; ++k)
      for (int l = &m == &n ? k + 1 : n.begin; l < n.end; ++l) {
        const int i = items_[k], j = items_[l];
        if (overlap(box(i), box(j)) && !f(std::min(i, j), std::max(i, j))) return false;
      }
    return true;
  }

  std::vector<Box> boxes_;
  std::vector<int> items_;
  std::vector<Node> nodes_{};
};

}  // namespace aussois
