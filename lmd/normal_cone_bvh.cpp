// SPDX-License-Identifier: Apache-2.0
#include "lmd/normal_cone_bvh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace aussois {
namespace {

constexpr double kConeWeight = 0.15;  // lambda: cone-only splitting hurts, none at all too

using Key = Eigen::Matrix<double, 6, 1>;

class Builder {
 public:
  Builder(const std::vector<BvhItem>& items, int leaf_size) : items_(items), leaf_size_(leaf_size) {
    bvh_.items.resize(items.size());
    std::iota(bvh_.items.begin(), bvh_.items.end(), 0);
    for (const BvhItem& item : items_) {
      Vec3 c = Vec3::Zero();
      for (int i = 0; i < item.point_count; ++i) c += item.points[i] / item.point_count;
      centroid_.push_back(c);
    }
    if (items.empty()) return;
    bvh_.nodes.emplace_back();
    fill(0, 0, int(items.size()));
  }
  NormalConeBvh take() { return std::move(bvh_); }

 private:
  void bound(BvhNode& node, int begin, int end) const {
    Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);
    for (int i = begin; i < end; ++i) {
      const BvhItem& item = items_[std::size_t(bvh_.items[std::size_t(i)])];
      for (int k = 0; k < item.point_count; ++k)
        lo = lo.cwiseMin(item.points[k]), hi = hi.cwiseMax(item.points[k]);
    }
    node.centre = (lo + hi) / 2;
    for (int i = begin; i < end; ++i) {
      const BvhItem& item = items_[std::size_t(bvh_.items[std::size_t(i)])];
      for (int k = 0; k < item.point_count; ++k)
        node.radius = std::max(node.radius, (item.points[k] - node.centre).norm());
      if (i == begin)
        node.axis = item.axis, node.half_angle = item.half_angle;
      else
        merge_caps(node.axis, node.half_angle, item.axis, item.half_angle);
      node.classes |= item.classes;
    }
    node.cos_half_angle = std::cos(node.half_angle);
    node.sin_half_angle = std::sin(node.half_angle);
    node.radius *= 1 + 1e-14;  // rounding of centre and distance
  }

  void fill(int index, int begin, int end) {
    BvhNode node;
    bound(node, begin, end);
    if (end - begin <= leaf_size_) {
      node.first = begin;
      node.count = end - begin;
      bvh_.nodes[std::size_t(index)] = node;
      return;
    }
    const double size = 2 * node.radius;
    const auto key = [&](int item) {
      Key k;
      k << centroid_[std::size_t(item)], kConeWeight * size * items_[std::size_t(item)].axis;
      return k;
    };
    Key lo = Key::Constant(kInf), hi = Key::Constant(-kInf);
    for (int i = begin; i < end; ++i) {
      const Key k = key(bvh_.items[std::size_t(i)]);
      lo = lo.cwiseMin(k);
      hi = hi.cwiseMax(k);
    }
    Eigen::Index side = 0;
    (hi - lo).maxCoeff(&side);
    const int middle = (begin + end) / 2;
    std::nth_element(bvh_.items.begin() + begin, bvh_.items.begin() + middle, bvh_.items.begin() + end,
                     [&](int a, int b) {
                       const double ka = key(a)(side), kb = key(b)(side);
                       return ka != kb ? ka < kb : a < b;
                     });
    const int child = int(bvh_.nodes.size());
    node.first = child;
    node.count = 0;
    bvh_.nodes[std::size_t(index)] = node;
    bvh_.nodes.resize(bvh_.nodes.size() + 2);
    fill(child, begin, middle);
    fill(child + 1, middle, end);
  }

  const std::vector<BvhItem>& items_;
  int leaf_size_;
  std::vector<Vec3> centroid_;
  NormalConeBvh bvh_;
};

}  // namespace

void merge_caps(Vec3& axis, double& half_angle, const Vec3& other_axis, double other_half_angle) {
  if (half_angle >= kPi) return;
  if (other_half_angle >= kPi) {
    half_angle = kPi;
    return;
  }
  const double between = std::atan2(axis.cross(other_axis).norm(), axis.dot(other_axis));
  if (between + other_half_angle <= half_angle) return;
  if (between + half_angle <= other_half_angle) {
    axis = other_axis;
    half_angle = other_half_angle;
    return;
  }
  const double merged = (half_angle + other_half_angle + between) / 2 + 1e-12;
  const Vec3 turn = axis.cross(other_axis);
  if (merged >= kPi || turn.norm() < 1e-12) {  // opposite axes have no rotation between them
    half_angle = merged >= kPi || between > 1 ? kPi : merged;
    return;
  }
  axis = Eigen::AngleAxisd(merged - half_angle, turn.normalized()) * axis;
  axis.normalize();
  half_angle = merged;
}

NormalConeBvh build_bvh(const std::vector<BvhItem>& items, int leaf_size) {
  return Builder(items, leaf_size).take();
}

}  // namespace aussois
