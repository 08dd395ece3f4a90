// SPDX-License-Identifier: Apache-2.0
#include "lmd/broad_phase.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr int kLeafSize = 4;         // 2 to 12 are within 15 % (decision record 0009)
constexpr int kParts = 256;          // pieces of work that threads share
constexpr double kRounding = 1e-14;  // of the coordinates: some ulps of the sums below
// Rooms are to last for so many queries like the last one, and for a little more of the radius; both are
// taste.
constexpr double kRoomOfQueries = 8, kRoomOfRadius = 1.0 / 16;
constexpr int kNeighboursOfAPart = 1024;  // of a piece of work

StraightBox bounds_of(const DilatedBox& box) {
  Vec3 reach = Vec3::Constant(box.radius);
  if (!box.half.isZero(0)) reach += box.axes.cwiseAbs() * box.half;
  const Vec3 slack = Vec3::Constant(kRounding * (box.centre.norm() + reach.sum()));
  return {box.centre - reach - slack, box.centre + reach + slack};
}

struct Node {
  StraightBox bounds{};
  int first = 0,
      count = 0;  // leaf: places first .. first + count - 1; otherwise count = 0, children first, first + 1
  bool moves = false;  // something below is not fixed
};

// Places are the boxes in the order of the leaves.
struct Tree {
  std::vector<Node> nodes{};
  std::vector<int> order{};           // box at a place
  std::vector<StraightBox> bounds{};  // of the boxes, by place
};

// Halves at the median of the centres along the axis of their largest spread.
class BoxTreeBuilder {
 public:
  BoxTreeBuilder(const std::vector<DilatedBox>& boxes, const std::vector<StraightBox>& bounds)
      : boxes_(boxes), bounds_(bounds) {
    tree_.order.resize(boxes.size());
    std::iota(tree_.order.begin(), tree_.order.end(), 0);
    tree_.nodes.emplace_back();
    if (!boxes.empty()) fill(0, 0, int(boxes.size()));
    for (int i : tree_.order) tree_.bounds.push_back(bounds_[i]);
  }
  Tree tree() && { return std::move(tree_); }

 private:
  void fill(int node, int begin, int end) {
    Node out{.first = begin, .count = end - begin};
    StraightBox centres;
    for (int k = begin; k < end; ++k) {
      const DilatedBox& box = boxes_[tree_.order[k]];
      const StraightBox& b = bounds_[tree_.order[k]];
      out.bounds.add(b.lo, b.hi);
      centres.add(box.centre, box.centre);
      out.moves = out.moves || !box.fixed;
    }
    if (out.count > kLeafSize) {
      const int middle = split_at_median(begin, end, centres);
      out.first = int(tree_.nodes.size());
      out.count = 0;
      tree_.nodes.resize(tree_.nodes.size() + 2);
      fill(out.first, begin, middle);
      fill(out.first + 1, middle, end);
    }
    tree_.nodes[node] = out;
  }

  int split_at_median(int begin, int end, const StraightBox& centres) {
    Eigen::Index axis = 0;
    (centres.hi - centres.lo).maxCoeff(&axis);
    const auto first = tree_.order.begin();
    const int middle = begin + (end - begin) / 2;
    std::nth_element(first + begin, first + middle, first + end, [&](int i, int j) {
      const double x = boxes_[i].centre[axis], y = boxes_[j].centre[axis];
      return x != y ? x < y : i < j;
    });
    return middle;
  }

  const std::vector<DilatedBox>& boxes_;
  const std::vector<StraightBox>& bounds_;
  Tree tree_{};
};

using IndexPair = std::pair<int, int>;

// What one part of the descent collects.
struct PartialPairs {
  std::vector<IndexPair> found{};
  BroadPhaseStatistics count{};
};

// Asks `near(i, j)` of boxes whose bounds meet, unless both are fixed.
template <class Near>
class Descent {
 public:
  Descent(const std::vector<DilatedBox>& boxes, const Tree& tree, const Near& near)
      : boxes_(boxes), tree_(tree), near_(near) {}

  // One pair of nodes: pairs of boxes if both are leaves, otherwise what is to be looked at next.
  void open(IndexPair at, std::vector<IndexPair>& next, PartialPairs& part) const {
    ++part.count.node_pairs;
    const auto [i, j] = at;
    const Node &n = tree_.nodes[i], &m = tree_.nodes[j];
    if ((!n.moves && !m.moves) || !n.bounds.meets(m.bounds)) return;
    if (i == j && n.count == 0) {
      next.insert(next.end(), {{n.first, n.first}, {n.first + 1, n.first + 1}, {n.first, n.first + 1}});
    } else if (n.count > 0 && m.count > 0) {
      for (int p = n.first; p < n.first + n.count; ++p)
        for (int q = i == j ? p + 1 : m.first; q < m.first + m.count; ++q) test(p, q, part);
    } else if (m.count > 0 || (n.count == 0 && n.bounds.width() >= m.bounds.width())) {
      next.insert(next.end(), {{n.first, j}, {n.first + 1, j}});
    } else {
      next.insert(next.end(), {{i, m.first}, {i, m.first + 1}});
    }
  }

 private:
  void test(int p, int q, PartialPairs& part) const {
    ++part.count.box_pairs;
    if (!tree_.bounds[p].meets(tree_.bounds[q])) return;
    const int i = tree_.order[p], j = tree_.order[q];
    if (boxes_[i].fixed && boxes_[j].fixed) return;
    if (near_(i, j)) part.found.push_back(std::minmax(i, j));
  }

  const std::vector<DilatedBox>& boxes_;
  const Tree& tree_;
  const Near& near_;
};

// By counting the pairs of each first index, then sorting its few partners.
std::vector<IndexPair> sorted_pairs(const std::vector<PartialPairs>& parts, std::size_t boxes) {
  std::vector<std::size_t> begin(boxes + 1, 0);
  for (const PartialPairs& part : parts)
    for (const IndexPair& pair : part.found) ++begin[std::size_t(pair.first) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<IndexPair> all(begin.back());
  std::vector<std::size_t> place(begin.begin(), begin.end() - 1);
  for (const PartialPairs& part : parts)
    for (const IndexPair& pair : part.found) all[place[pair.first]++] = pair;
  for (std::size_t i = 0; i < boxes; ++i)
    std::sort(all.begin() + std::ptrdiff_t(begin[i]), all.begin() + std::ptrdiff_t(begin[i + 1]));
  return all;
}

template <class Near>
std::vector<IndexPair> pairs_in_tree(const std::vector<DilatedBox>& boxes,
                                     const std::vector<StraightBox>& bounds, const Near& near, int threads,
                                     BroadPhaseStatistics* statistics) {
  const Tree tree = BoxTreeBuilder(boxes, bounds).tree();
  const Descent<Near> descent(boxes, tree, near);
  std::vector<PartialPairs> parts(1);
  std::vector<IndexPair> front{{0, 0}};
  while (!front.empty() && int(front.size()) < kParts) {  // breadth first until there is enough to share
    std::vector<IndexPair> next;
    for (const IndexPair& at : front) descent.open(at, next, parts[0]);
    front = std::move(next);
  }
  parts.resize(1 + front.size());
  parallel_for(int(front.size()), threads, [&](int k) {
    std::vector<IndexPair> stack{front[k]};
    while (!stack.empty()) {
      const IndexPair at = stack.back();
      stack.pop_back();
      descent.open(at, stack, parts[std::size_t(k) + 1]);
    }
  });
  if (statistics) {
    *statistics = {};
    for (const PartialPairs& part : parts) {
      statistics->node_pairs += part.count.node_pairs;
      statistics->box_pairs += part.count.box_pairs;
    }
  }
  return sorted_pairs(parts, boxes.size());
}

std::vector<StraightBox> bounds_of(const std::vector<DilatedBox>& boxes) {
  std::vector<StraightBox> out;
  out.reserve(boxes.size());
  for (const DilatedBox& box : boxes) {
    AUSSOIS_ASSERT(box.centre.allFinite());
    out.push_back(bounds_of(box));
  }
  return out;
}

bool all_in_their_rooms(const std::vector<DilatedBox>& boxes, const std::vector<StraightBox>& bounds,
                        const BroadPhaseScratch& scratch) {
  if (boxes.size() != scratch.room.size()) return false;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].fixed != bool(scratch.fixed[i]) || !scratch.room[i].holds(bounds[i])) return false;
  return true;
}

void make_rooms(const std::vector<DilatedBox>& boxes, const std::vector<StraightBox>& bounds, int threads,
                BroadPhaseScratch& scratch) {
  const bool again = scratch.last.size() == boxes.size();
  scratch.room.clear();
  scratch.fixed.clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double moved = again ? bounds[i].farthest_side(scratch.last[i]) : 0;
    scratch.room.push_back(bounds[i].enlarged(kRoomOfQueries * moved + kRoomOfRadius * boxes[i].radius));
    scratch.fixed.push_back(boxes[i].fixed);
  }
  const auto any = [](int, int) { return true; };
  scratch.neighbours = pairs_in_tree(boxes, scratch.room, any, threads, nullptr);
}

DilatedBox box_along(const Mat3& axes, std::span<const Vec3> points) {
  StraightBox b;
  for (const Vec3& x : points) b.add(axes.transpose() * x, axes.transpose() * x);
  return {.centre = axes * (b.lo + b.hi) / 2, .axes = axes, .half = (b.hi - b.lo) / 2};
}

// A ball's centre and a box without dilation; negative inside.
double distance_of(const Vec3& centre, const DilatedBox& box) {
  const Vec3 beyond = (box.axes.transpose() * (centre - box.centre)).cwiseAbs() - box.half;
  const double farthest = beyond.maxCoeff();
  return farthest > 0 ? beyond.cwiseMax(0).norm() : farthest;
}

}  // namespace

DilatedBox box_around(std::span<const Vec3> points) {
  require(!points.empty(), "box_around: there must be a point");
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : points) mean += x / double(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : points) spread += (x - mean) * (x - mean).transpose();
  const auto surface = [](const DilatedBox& box) {
    return box.half.x() * box.half.y() + box.half.y() * box.half.z() + box.half.z() * box.half.x();
  };
  const DilatedBox straight = box_along(Mat3::Identity(), points),
                   turned = box_along(Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors(), points);
  // One per cent: where both are equally good rounding must not choose.
  return surface(turned) < 0.99 * surface(straight) ? turned : straight;
}

DilatedBox operator*(const SE3& g, const DilatedBox& box) {
  DilatedBox out = box;
  out.centre = g * box.centre;
  out.axes = g.R.toRotationMatrix() * box.axes;
  return out;
}

double separation(const DilatedBox& a, const DilatedBox& b) {
  const Vec3 c = b.centre - a.centre;
  const double distance = c.norm(), radii = a.radius + b.radius;
  const double slack = kRounding * (a.centre.norm() + b.centre.norm() + a.half.sum() + b.half.sum() + radii);
  const bool a_is_ball = a.half.isZero(0), b_is_ball = b.half.isZero(0);
  if (a_is_ball && b_is_ball) return distance - radii - slack;
  if (a_is_ball) return distance_of(a.centre, b) - radii - slack;
  if (b_is_ball) return distance_of(b.centre, a) - radii - slack;
  double widest = -kInf;
  const auto reach = [](const DilatedBox& box, const Vec3& n) {
    return box.half.dot((box.axes.transpose() * n).cwiseAbs());
  };
  const auto along = [&](const Vec3& n) {
    widest = std::max(widest, std::abs(c.dot(n)) - (reach(a, n) + reach(b, n)));
  };
  if (distance > 0) along(c / distance);
  for (int i = 0; i < 3; ++i) along(a.axes.col(i)), along(b.axes.col(i));
  if (widest - radii - slack > 0) return widest - radii - slack;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3 n = a.axes.col(i).cross(b.axes.col(j));
      if (const double length = n.norm(); length > 1e-6) along(n / length);  // parallel edges add no axis
    }
  return widest - radii - slack;
}

std::vector<std::pair<int, int>> broad_phase(const std::vector<DilatedBox>& boxes, int threads,
                                             BroadPhaseStatistics* statistics) {
  const auto near = [&](int i, int j) { return !(separation(boxes[i], boxes[j]) > 0); };
  return pairs_in_tree(boxes, bounds_of(boxes), near, threads, statistics);
}

std::vector<std::pair<int, int>> broad_phase(const std::vector<DilatedBox>& boxes, int threads,
                                             BroadPhaseScratch& scratch) {
  std::vector<StraightBox> bounds = bounds_of(boxes);
  if (!all_in_their_rooms(boxes, bounds, scratch)) make_rooms(boxes, bounds, threads, scratch);
  const auto near = [&](const IndexPair& pair) {
    const auto i = std::size_t(pair.first), j = std::size_t(pair.second);
    return bounds[i].meets(bounds[j]) && !(separation(boxes[i], boxes[j]) > 0);
  };
  const std::vector<IndexPair>& all = scratch.neighbours;
  std::vector<std::vector<IndexPair>> found((all.size() + kNeighboursOfAPart - 1) / kNeighboursOfAPart);
  parallel_for(int(found.size()), threads, [&](int k) {
    const std::size_t first = std::size_t(k) * kNeighboursOfAPart;
    const std::size_t count = std::min(all.size() - first, std::size_t(kNeighboursOfAPart));
    std::ranges::copy_if(std::span(all).subspan(first, count), std::back_inserter(found[k]), near);
  });
  scratch.last = std::move(bounds);
  std::vector<IndexPair> pairs;
  for (const std::vector<IndexPair>& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

std::size_t bytes_of(const BroadPhaseScratch& scratch) {
  return (scratch.last.capacity() + scratch.room.capacity()) * sizeof(StraightBox) +
         scratch.fixed.capacity() + scratch.neighbours.capacity() * sizeof(std::pair<int, int>);
}

}  // namespace aussois
