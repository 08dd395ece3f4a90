// SPDX-License-Identifier: Apache-2.0
// A hierarchy of balls, normal cones and class sets over simplices (LMD-9). The oriented boxes of the full
// 5D+1 node come with their own issue; they would be one more field here and one more test in the traversals.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct BvhNode {
  Vec3 centre = Vec3::Zero();  // of a ball around the undilated simplices, frame of the shape [m]
  double radius = 0;           // [m]
  Vec3 axis = Vec3::UnitZ();   // of a cap around the normal cones, unit
  double half_angle = 0;       // of that cap [rad]; pi: any direction
  double cos_half_angle = 1, sin_half_angle = 0;
  std::uint32_t classes = 0;  // bit c: a simplex of class c lies below
  int first = 0;              // leaf: its first item; branch: its first child, the second follows
  int count = 0;              // leaf: number of items; branch: 0
};

struct NormalConeBvh {
  std::vector<BvhNode> nodes{};  // the root first; empty if there are no items
  std::vector<int> items{};
};

/// What the builder needs of an item: up to three points and the cap around its normal cone.
struct BvhItem {
  Vec3 points[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  int point_count = 1;
  Vec3 axis = Vec3::UnitZ();
  double half_angle = kPi;
  std::uint32_t classes = 0;
};

/// Median split along the longest side in the space (position, lambda times axis); balls around points, not
/// around balls.
NormalConeBvh build_bvh(const std::vector<BvhItem>& items, int leaf_size = 1);

/// The smallest cap found around two caps.
void merge_caps(Vec3& axis, double& half_angle, const Vec3& other_axis, double other_half_angle);

}  // namespace aussois
