// SPDX-License-Identifier: Apache-2.0
#include "lmd/cone_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr double kConeWeight = 0.1;  // lambda (LMD-13)
constexpr std::size_t kManyRanges =
    256;  // enough for all threads: each builds one after the other to its end

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

float up(double x) {  // a float that is not smaller
  return std::nextafter(float(x), std::numeric_limits<float>::infinity());
}

struct Bounds {
  Eigen::Vector3f c, axis, h;
  Eigen::Matrix3f u;  // columns
  float r, cos, sin;
};

// A node, and the simplices below it by their places in the order.
struct Range {
  std::size_t node = 0;
  int begin = 0, end = 0;
};
struct Ranges {
  std::array<Range, 4> of{};
  int count = 0;
  std::span<const Range> span() const { return std::span(of).first(std::size_t(count)); }
};

// How many simplices a child of a node over so many has: all but the last are full, so no space is lost.
int full_child(int count) {
  int full = kBucket;
  while (4 * full < count) full *= 4;
  return full;
}

// Nodes of the tree over so many simplices; a bucket is none.
std::size_t node_count(int count) {
  if (count <= kBucket) return 0;
  const int full = full_child(count), last = (count - 1) % full + 1;
  std::size_t of_full = 0;
  for (int size = kBucket; size < full; size *= 4) of_full = 1 + 4 * of_full;
  return 1 + std::size_t((count - 1) / full) * of_full + node_count(last);
}

class ConeTreeBuilder {
 public:
  ConeTreeBuilder(const std::vector<ConeTreeItem>& items, std::span<const Vec3> vertices, const Vec3& centre,
                  std::vector<int>& order, int threads)
      : items_(items), vertices_(vertices), centre_(centre), order_(order) {
    order_.resize(items.size());
    std::iota(order_.begin(), order_.end(), 0);
    if (items.empty()) return;
    place_.reserve(items.size());
    half_angle_.reserve(items.size());
    Vec3 lo = Vec3::Constant(kInf), hi = -lo;
    for (const ConeTreeItem& item : items) {
      Vec3 c = Vec3::Zero();
      for (int v : corners(item)) c += vertices_[v] / item.vertex_count;
      lo = lo.cwiseMin(c);
      hi = hi.cwiseMax(c);
      place_.emplace_back() << c, item.axis;
      half_angle_.emplace_back(std::cos(item.half_angle), std::sin(item.half_angle));
    }
    size_ = (hi - lo).norm();
    key_.resize(items.size());
    nodes_.resize(std::max(node_count(int(items.size())), std::size_t(1)));  // a lone bucket has a root
    build({0, 0, int(items.size())}, threads);
  }
  ConeTree take() { return {std::move(nodes_)}; }

 private:
  const ConeTreeItem& item(int i) const { return items_[order_[i]]; }
  static std::span<const int> corners(const ConeTreeItem& item) {
    return std::span(item.vertex).first(std::size_t(item.vertex_count));
  }

  // Principal axes of the corners, or those of the frame where they give the smaller box.
  void box(Bounds& out, int begin, int end) const {
    const Vec3 first = vertices_[item(begin).vertex[0]];
    Vec3 sum = Vec3::Zero();
    Mat3 S = Mat3::Zero();
    int n = 0;
    for (int i = begin; i < end; ++i)
      for (int v : corners(item(i))) {
        const Vec3 d = vertices_[v] - first;
        sum += d;
        S += d * d.transpose();
        ++n;
      }
    const Vec3 mean = first + sum / n;
    S -= sum * sum.transpose() / n;
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(S);
    double smallest = kInf;
    for (const Mat3& axes : {Mat3(Mat3::Identity()), solver.eigenvectors()}) {
      Eigen::Matrix3f rounded = axes.cast<float>();
      rounded.col(2) = rounded.col(0).cross(rounded.col(1));
      if (!(rounded.transpose() * rounded - Eigen::Matrix3f::Identity()).isZero(1e-5F)) continue;
      const Mat3 u = rounded.cast<double>();
      Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);
      for (int i = begin; i < end; ++i)
        for (int v : corners(item(i))) {
          const Vec3 x = u.transpose() * (vertices_[v] - mean);
          lo = lo.cwiseMin(x);
          hi = hi.cwiseMax(x);
        }
      const Vec3 side = hi - lo;
      const double area = side.x() * side.y() + side.y() * side.z() + side.z() * side.x();
      if (area >= smallest) continue;
      smallest = area;
      out.u = rounded;
      out.c = (u * (lo + hi) / 2 + mean - centre_).cast<float>();
    }
    out.h.setZero();
    out.r = 0;
    const Vec3 c = out.c.cast<double>() + centre_;  // as rounded
    const Mat3 u = out.u.cast<double>();
    Vec3 h = Vec3::Zero();
    double r = 0;
    for (int i = begin; i < end; ++i)
      for (int v : corners(item(i))) {
        const Vec3 d = vertices_[v] - c;
        h = h.cwiseMax((u.transpose() * d).cwiseAbs());
        r = std::max(r, d.squaredNorm());
      }
    for (int k = 0; k < 3; ++k) out.h[k] = up(h[k] * (1 + 1e-6));
    out.r = up(std::sqrt(r) * (1 + 1e-12));
  }

  // Around the mean axis, the largest sum of the angle to an axis and its half angle.
  void cap(Bounds& out, int begin, int end) const {
    out.axis.setUnit(2);
    out.cos = -1, out.sin = 0;
    Vec3 sum = Vec3::Zero();
    for (int i = begin; i < end; ++i) sum += item(i).axis;
    if (end - begin > 1 && sum.norm() < 1e-3 * (end - begin)) return;
    const Vec3 axis = sum.normalized();
    double cos = 1, sin = 0;
    for (int i = begin; i < end; ++i) {
      if (item(i).half_angle >= kPi) return;
      const double c = std::min(1.0, axis.dot(item(i).axis)), s = axis.cross(item(i).axis).norm();
      const auto& [ch, sh] = half_angle_[order_[i]];
      const double total = c * ch - s * sh;
      if (s * ch + c * sh < 0) return;  // past pi
      if (total < cos) cos = total, sin = s * ch + c * sh;
    }
    out.axis = axis.cast<float>();
    out.cos = float(cos), out.sin = float(sin);
  }

  void set_child(std::size_t node, int lane, int begin, int end) {
    Bounds b;
    box(b, begin, end);
    cap(b, begin, end);
    ConeNode& n = nodes_[node];
    for (int i = 0; i < 3; ++i) {
      n.c[i][lane] = b.c[i];
      n.axis[i][lane] = b.axis[i];
      n.h[i][lane] = b.h[i];
      for (int k = 0; k < 2; ++k) n.u[k][i][lane] = b.u(i, k);
    }
    n.r[lane] = b.r;
    n.cos[lane] = b.cos;
    n.sin[lane] = b.sin;
    n.child[lane] = std::uint32_t(begin);
    n.count[lane] = std::uint32_t(end - begin);
  }

  // Sorts the range about its `middle` by (LMD-13): large ranges are cut by position, small ones by
  // direction, so the two flanks of a thread come apart where that makes thin boxes, not before.
  void split(int begin, int middle, int end) {
    const Vec6 first = place_[order_[begin]];
    Vec6 sum = Vec6::Zero(), lo = Vec6::Zero(), hi = Vec6::Zero();
    Mat6 S = Mat6::Zero();
    for (int i = begin; i < end; ++i) {
      const Vec6 d = place_[order_[i]] - first;
      sum += d;
      S += d * d.transpose();
      lo = lo.cwiseMin(d);
      hi = hi.cwiseMax(d);
    }
    S -= sum * sum.transpose() / (end - begin);
    Vec6 weight = Vec6::Ones();
    weight.tail<3>().setConstant(kConeWeight * std::sqrt((hi - lo).head<3>().norm() * size_));
    S = weight.asDiagonal() * S * weight.asDiagonal();
    Eigen::Index widest = 0;
    S.diagonal().maxCoeff(&widest);
    const Vec6 axis = weight.cwiseProduct(S.col(widest));
    for (int i = begin; i < end; ++i) {
      const auto at = std::size_t(order_[i]);
      key_[at] = axis.dot(place_[at] - first);
    }
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) {
                       const double ka = key_[a], kb = key_[b];
                       return ka != kb ? ka < kb : a < b;
                     });
  }

  // Level by level while there are few nodes, then each of the many to its end.
  void build(const Range& all, int threads) {
    std::vector<Range> level{all};
    while (!level.empty() && level.size() < kManyRanges) {
      std::vector<Ranges> below(level.size());
      parallel_for(int(level.size()), threads, [&](int i) { below[i] = open(level[i]); });
      level.clear();
      for (const Ranges& ranges : below)
        level.insert(level.end(), ranges.span().begin(), ranges.span().end());
    }
    parallel_for(int(level.size()), threads, [&](int i) { fill(level[i]); });
  }

  void fill(const Range& range) {
    const Ranges below = open(range);
    for (const Range& child : below.span()) fill(child);
  }

  // Sets the node and returns those below it.
  Ranges open(const Range& range) {
    const auto [node, begin, end] = range;
    const int full = full_child(end - begin);
    const int count = (end - begin + full - 1) / full;
    int bounds[5];
    for (int k = 0; k <= count; ++k) bounds[k] = std::min(begin + k * full, end);
    const int half = (count + 1) / 2;  // binary splits
    if (count > 1) split(begin, bounds[half], end);
    if (half > 1) split(begin, bounds[1], bounds[half]);
    if (count - half > 1) split(bounds[half], bounds[half + 1], end);
    for (int lane = 0; lane < 4; ++lane) {
      if (lane < count) {
        set_child(node, lane, bounds[lane], bounds[lane + 1]);
      } else {
        ConeNode& n = nodes_[node];
        for (auto& x : n.c) x[lane] = 0;
        n.r[lane] = -1;
        n.cos[lane] = -1;
        n.sin[lane] = 0;
        for (auto& x : n.axis) x[lane] = 0;
        for (auto& axis : n.u)
          for (auto& x : axis) x[lane] = 0;
        for (auto& x : n.h) x[lane] = 0;
        n.child[lane] = n.count[lane] = 0;
      }
    }
    Ranges below;
    std::size_t next = node + 1;
    for (int lane = 0; lane < count; ++lane) {
      const int size = bounds[lane + 1] - bounds[lane];
      if (size <= kBucket) continue;
      nodes_[node].child[lane] = std::uint32_t(next);
      nodes_[node].count[lane] = 0;
      below.of[below.count++] = {next, bounds[lane], bounds[lane + 1]};
      next += node_count(size);
    }
    return below;
  }

  const std::vector<ConeTreeItem>& items_;
  std::span<const Vec3> vertices_;
  Vec3 centre_;
  std::vector<int>& order_;
  std::vector<Vec6> place_;                            // centroid and axis of the cone
  std::vector<std::pair<double, double>> half_angle_;  // cos and sin
  std::vector<double> key_;
  double size_ = 0;  // of all
  std::vector<ConeNode> nodes_{};
};

}  // namespace

ConeTree build_cone_tree(const std::vector<ConeTreeItem>& items, std::span<const Vec3> vertices,
                         const Vec3& centre, std::vector<int>& order, int threads) {
  return ConeTreeBuilder(items, vertices, centre, order, threads).take();
}

}  // namespace aussois
