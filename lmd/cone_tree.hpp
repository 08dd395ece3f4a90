// SPDX-License-Identifier: Apache-2.0
// Builds the 5D+1 hierarchy (LMD-9): around the simplices of each class a ball, an oriented box and a cap of
// the normal cones. A node holds four children side by side, in single precision and rounded outwards, so
// that one instruction tests four.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/shared_array.hpp"
#include "geometry/types.hpp"

namespace aussois {

/// Four children; lengths in the frame of the shape, relative to its centre [m].
struct alignas(64) ConeNode {
  // What every test reads.
  float c[3][4];           // centres of balls and boxes
  float r[4];              // of the balls; -1 for a missing child
  float axis[3][4];        // of the caps, unit
  float cos[4], sin[4];    // of their half angles; (-1, 0): any direction
  std::uint32_t child[4];  // a node, or the first simplex of a bucket
  std::uint32_t count[4];  // simplices in the bucket; 0: a node
  // Read only if the tests of balls and caps say yes.
  float u[2][3][4];  // two axes of the boxes, the third is their product; u[k][i]: coordinate i of axis k
  float h[3][4];     // their half sides
};

/// What the builder needs of a simplex: its vertices and the cap around its normal cone.
struct ConeTreeItem {
  std::array<int, 3> vertex{};
  int vertex_count = 1;
  Vec3 axis = Vec3::UnitZ();
  double half_angle = kPi;
};

/// Largest number of simplices in a bucket.
inline constexpr int kBucket = 4;

/// A tree over simplices of one class; it determines their order.
struct ConeTree {
  SharedArray<ConeNode> nodes{};  // the root first; empty without simplices
};

/// Median splits by position and axis of the cone (LMD-13). `order` receives the items in the order of the
/// buckets. The tree is the same for any number of threads.
ConeTree build_cone_tree(const std::vector<ConeTreeItem>& items, std::span<const Vec3> vertices,
                         const Vec3& centre, std::vector<int>& order, int threads = 1);
/// A tree over items in an order that stands, in time linear in their number: what is around the simplices of
/// an inner node is what encloses its children.
ConeTree enclosing_cone_tree(const std::vector<ConeTreeItem>& items, std::span<const Vec3> vertices,
                             const Vec3& centre);

}  // namespace aussois
