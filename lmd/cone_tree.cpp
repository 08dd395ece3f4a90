// SPDX-License-Identifier: Apache-2.0
#include "lmd/cone_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace aussois {
namespace {

constexpr double kConeWeight = 0.15;  // lambda: cone-only splitting hurts, none at all too

float up(double x) {  // a float that is not smaller
  return std::nextafter(float(x), std::numeric_limits<float>::infinity());
}

struct Bounds {
  Eigen::Vector3f c, axis, h;
  Eigen::Matrix3f u;  // columns
  float r, cos, sin;
};

class Builder {
 public:
  Builder(const std::vector<ConeTreeItem>& items, const Vec3& centre, std::vector<int>& order)
      : items_(items), centre_(centre), order_(order) {
    order_.resize(items.size());
    std::iota(order_.begin(), order_.end(), 0);
    for (const ConeTreeItem& item : items) {
      Vec3 c = Vec3::Zero();
      for (int i = 0; i < item.point_count; ++i) c += item.points[i] / item.point_count;
      centroid_.push_back(c);
    }
    key_.resize(items.size());
    if (items.empty()) return;
    tree_.nodes.reserve(items.size() / 2 + 1);
    tree_.nodes.emplace_back();
    fill(0, 0, int(items.size()));
  }
  ConeTree take() { return std::move(tree_); }

 private:
  const ConeTreeItem& item(int i) const { return items_[std::size_t(order_[std::size_t(i)])]; }

  // Principal axes of the corners, or those of the frame where they give the smaller box.
  void box(Bounds& out, int begin, int end) const {
    Vec3 mean = Vec3::Zero();
    int n = 0;
    for (int i = begin; i < end; ++i)
      for (int k = 0; k < item(i).point_count; ++k) mean += item(i).points[k], ++n;
    mean /= n;
    Mat3 S = Mat3::Zero();
    for (int i = begin; i < end; ++i)
      for (int k = 0; k < item(i).point_count; ++k) {
        const Vec3 d = item(i).points[k] - mean;
        S += d * d.transpose();
      }
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
        for (int k = 0; k < item(i).point_count; ++k) {
          const Vec3 x = u.transpose() * (item(i).points[k] - mean);
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
      for (int k = 0; k < item(i).point_count; ++k) {
        const Vec3 d = item(i).points[k] - c;
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
      const double ch = std::cos(item(i).half_angle), sh = std::sin(item(i).half_angle);
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
    ConeNode& n = tree_.nodes[node];
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

  // Sorts the range about its `middle` along its longest side.
  void split(int begin, int middle, int end) {
    Eigen::Matrix<double, 6, 1> lo = Eigen::Matrix<double, 6, 1>::Constant(kInf), hi = -lo;
    for (int i = begin; i < end; ++i) {
      const Vec3& c = centroid_[std::size_t(order_[std::size_t(i)])];
      lo.head<3>() = lo.head<3>().cwiseMin(c);
      hi.head<3>() = hi.head<3>().cwiseMax(c);
      lo.tail<3>() = lo.tail<3>().cwiseMin(item(i).axis);
      hi.tail<3>() = hi.tail<3>().cwiseMax(item(i).axis);
    }
    const double size = (hi - lo).head<3>().norm();
    Eigen::Matrix<double, 6, 1> side = hi - lo;
    side.tail<3>() *= kConeWeight * size;
    Eigen::Index longest = 0;
    side.maxCoeff(&longest);
    for (int i = begin; i < end; ++i) {
      const auto at = std::size_t(order_[std::size_t(i)]);
      key_[at] = longest < 3 ? centroid_[at][longest] : items_[at].axis[longest - 3];
    }
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) {
                       const double ka = key_[std::size_t(a)], kb = key_[std::size_t(b)];
                       return ka != kb ? ka < kb : a < b;
                     });
  }

  void fill(std::size_t node, int begin, int end) {
    int full = kBucket;  // simplices of a child: all but the last are full, so no space is lost
    while (4 * full < end - begin) full *= 4;
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
        ConeNode& n = tree_.nodes[node];
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
    for (int lane = 0; lane < count; ++lane) {
      if (bounds[lane + 1] - bounds[lane] <= kBucket) continue;
      const std::size_t child = tree_.nodes.size();
      tree_.nodes.emplace_back();
      tree_.nodes[node].child[lane] = std::uint32_t(child);
      tree_.nodes[node].count[lane] = 0;
      fill(child, bounds[lane], bounds[lane + 1]);
    }
  }

  const std::vector<ConeTreeItem>& items_;
  Vec3 centre_;
  std::vector<int>& order_;
  std::vector<Vec3> centroid_;
  std::vector<double> key_;
  ConeTree tree_;
};

}  // namespace

ConeTree build_cone_tree(const std::vector<ConeTreeItem>& items, const Vec3& centre,
                         std::vector<int>& order) {
  return Builder(items, centre, order).take();
}

}  // namespace aussois
