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
                  std::vector<int>& order)
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
    nodes_.resize(std::max(node_count(int(items.size())), std::size_t(1)));  // a lone bucket has a root
  }
  /// Orders the items by splits.
  ConeTree split_up(int threads) {
    key_.resize(items_.size());
    if (!items_.empty()) build(all(), threads);
    return {std::move(nodes_)};
  }
  /// Leaves them in their order.
  ConeTree enclosed() {
    if (!items_.empty()) enclose(all());
    return {std::move(nodes_)};
  }

 private:
  Range all() const { return {0, 0, int(items_.size())}; }
  const ConeTreeItem& item(int i) const { return items_[order_[i]]; }
  static std::span<const int> corners(const ConeTreeItem& item) {
    return std::span(item.vertex).first(std::size_t(item.vertex_count));
  }

  // The corners of a range: their number, sum and second moments about `from`.
  struct Moments {
    int n = 0;
    Vec3 sum = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    void add(const Vec3& d) { ++n, sum += d, second += d * d.transpose(); }
    void add(const Moments& other) { n += other.n, sum += other.sum, second += other.second; }
    Mat3 scatter() const { return second - sum * sum.transpose() / n; }
  };
  Moments moments(int begin, int end, const Vec3& from) const {
    Moments out;
    for (int i = begin; i < end; ++i)
      for (int v : corners(item(i))) out.add(vertices_[v] - from);
    return out;
  }

  // Principal axes, or those of the frame where they give the smaller box. `sides(axes)` are the lower and
  // upper ends of the box along axes, about `origin`.
  void axes(Bounds& out, const Mat3& scatter, const Vec3& origin, const auto& sides) const {
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(scatter);
    double smallest = kInf;
    for (const Mat3& axes : {Mat3(Mat3::Identity()), solver.eigenvectors()}) {
      Eigen::Matrix3f rounded = axes.cast<float>();
      rounded.col(2) = rounded.col(0).cross(rounded.col(1));
      if (!(rounded.transpose() * rounded - Eigen::Matrix3f::Identity()).isZero(1e-5F)) continue;
      const Mat3 u = rounded.cast<double>();
      const auto [lo, hi] = sides(u);
      const Vec3 side = hi - lo;
      const double area = side.x() * side.y() + side.y() * side.z() + side.z() * side.x();
      if (area >= smallest) continue;
      smallest = area;
      out.u = rounded;
      out.c = (u * (lo + hi) / 2 + origin - centre_).template cast<float>();
    }
  }

  void box(Bounds& out, int begin, int end) const {
    const Vec3 first = vertices_[item(begin).vertex[0]];
    const Moments of = moments(begin, end, first);
    const Vec3 mean = first + of.sum / of.n;
    axes(out, of.scatter(), mean, [&](const Mat3& u) {
      Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);
      for (int i = begin; i < end; ++i)
        for (int v : corners(item(i))) {
          const Vec3 x = u.transpose() * (vertices_[v] - mean);
          lo = lo.cwiseMin(x);
          hi = hi.cwiseMax(x);
        }
      return std::pair(lo, hi);
    });
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

  // What lies below a child, for the node above it.
  struct Summary {
    Bounds bounds{};
    Moments corners;               // about the centre of the shape
    Vec3 axes_sum = Vec3::Zero();  // of the cones
    int count = 0;                 // simplices
  };
  Summary summary_of_bucket(int begin, int end) const {
    Summary out{.corners = moments(begin, end, centre_), .count = end - begin};
    box(out.bounds, begin, end);
    cap(out.bounds, begin, end);
    for (int i = begin; i < end; ++i) out.axes_sum += item(i).axis;
    return out;
  }
  // The box around boxes, the ball around balls, the cap around caps.
  Summary joined(std::span<const Summary> parts) const {
    Summary out;
    for (const Summary& part : parts)
      out.corners.add(part.corners), out.axes_sum += part.axes_sum, out.count += part.count;
    const auto sides = [&](const Mat3& u) {
      Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);
      for (const Summary& part : parts) {
        const Vec3 c = u.transpose() * part.bounds.c.cast<double>(),
                   h = (u.transpose() * part.bounds.u.cast<double>()).cwiseAbs() *
                       part.bounds.h.cast<double>();
        lo = lo.cwiseMin(c - h);
        hi = hi.cwiseMax(c + h);
      }
      return std::pair(lo, hi);
    };
    axes(out.bounds, out.corners.scatter(), centre_, sides);
    const Vec3 c = out.bounds.c.cast<double>();  // as rounded
    const Mat3 u = out.bounds.u.cast<double>();
    const auto [lo, hi] = sides(u);
    const Vec3 middle = u.transpose() * c, h = (hi - middle).cwiseMax(middle - lo);
    double r = 0;
    for (const Summary& part : parts)
      r = std::max(r, (part.bounds.c.cast<double>() - c).norm() + double(part.bounds.r));
    for (int k = 0; k < 3; ++k) out.bounds.h[k] = up(h[k] * (1 + 1e-6));
    out.bounds.r = up(std::min(r, h.norm()) * (1 + 1e-6));
    join_caps(out, parts);
    return out;
  }
  static void join_caps(Summary& out, std::span<const Summary> parts) {
    out.bounds.axis.setUnit(2);
    out.bounds.cos = -1, out.bounds.sin = 0;
    if (out.axes_sum.norm() < 1e-3 * out.count) return;
    const Vec3 axis = out.axes_sum.normalized();
    double cos = 1, sin = 0;
    for (const Summary& part : parts) {
      const Vec3 of_part = part.bounds.axis.cast<double>();
      const double ch = part.bounds.cos, sh = part.bounds.sin, c = std::min(1.0, axis.dot(of_part)),
                   s = axis.cross(of_part).norm(), total_cos = c * ch - s * sh, total_sin = s * ch + c * sh;
      if (ch <= -1 || total_sin < 0) return;                                    // past pi
      if (total_sin * cos > total_cos * sin) cos = total_cos, sin = total_sin;  // the larger angle
    }
    constexpr double kSingle = 1e-6;  // of the children's single precision [rad]
    if (sin + kSingle * cos < 0) return;
    out.bounds.axis = axis.cast<float>();
    out.bounds.cos = float(cos - kSingle * sin), out.bounds.sin = float(sin + kSingle * cos);
  }

  void set_child(std::size_t node, int lane, int begin, int end) {
    Bounds b;
    box(b, begin, end);
    cap(b, begin, end);
    set_child(node, lane, b, begin, end);
  }
  void set_child(std::size_t node, int lane, const Bounds& b, int begin, int end) {
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
  void build(const Range& whole, int threads) {
    std::vector<Range> level{whole};
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

  void set_missing(std::size_t node, int lane) {
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
  void lead_to(std::size_t node, int lane, std::size_t below) {
    nodes_[node].child[lane] = std::uint32_t(below);
    nodes_[node].count[lane] = 0;
  }

  // Where the children of a range begin and end.
  struct Children {
    int count = 0;
    std::array<int, 5> bounds{};
  };
  static Children children_of(const Range& range) {
    const int full = full_child(range.end - range.begin);
    Children out{.count = (range.end - range.begin + full - 1) / full};
    for (int k = 0; k <= out.count; ++k) out.bounds[k] = std::min(range.begin + k * full, range.end);
    return out;
  }

  // Sets the node and returns those below it.
  Ranges open(const Range& range) {
    const auto [node, begin, end] = range;
    const auto [count, bounds] = children_of(range);
    const int half = (count + 1) / 2;  // binary splits
    if (count > 1) split(begin, bounds[half], end);
    if (half > 1) split(begin, bounds[1], bounds[half]);
    if (count - half > 1) split(bounds[half], bounds[half + 1], end);
    for (int lane = 0; lane < 4; ++lane) {
      if (lane < count)
        set_child(node, lane, bounds[lane], bounds[lane + 1]);
      else
        set_missing(node, lane);
    }
    Ranges below;
    std::size_t next = node + 1;
    for (int lane = 0; lane < count; ++lane) {
      const int size = bounds[lane + 1] - bounds[lane];
      if (size <= kBucket) continue;
      lead_to(node, lane, next);
      below.of[below.count++] = {next, bounds[lane], bounds[lane + 1]};
      next += node_count(size);
    }
    return below;
  }

  // Sets the node and all below it, from the buckets up; the order stands.
  Summary enclose(const Range& range) {
    const auto [count, bounds] = children_of(range);
    std::array<Summary, 4> parts;
    std::size_t next = range.node + 1;
    for (int lane = 0; lane < 4; ++lane) {
      if (lane >= count) {
        set_missing(range.node, lane);
        continue;
      }
      const int begin = bounds[lane], end = bounds[lane + 1];
      const bool is_bucket = end - begin <= kBucket;
      parts[lane] = is_bucket ? summary_of_bucket(begin, end) : enclose({next, begin, end});
      set_child(range.node, lane, parts[lane].bounds, begin, end);
      if (is_bucket) continue;
      lead_to(range.node, lane, next);
      next += node_count(end - begin);
    }
    return joined(std::span(parts).first(std::size_t(count)));
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
  return ConeTreeBuilder(items, vertices, centre, order).split_up(threads);
}

ConeTree enclosing_cone_tree(const std::vector<ConeTreeItem>& items, std::span<const Vec3> vertices,
                             const Vec3& centre) {
  std::vector<int> order;
  return ConeTreeBuilder(items, vertices, centre, order).enclosed();
}

}  // namespace aussois
