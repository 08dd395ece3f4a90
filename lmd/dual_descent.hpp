// SPDX-License-Identifier: Apache-2.0
// Descends two trees at once: moves every node of A to B's frame once, and keeps the list of the nodes of B
// that can matter to it. The work is cut into the same parts for any number of threads.
#pragma once

#include <array>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/cone_tree.hpp"
#include "lmd/simd.hpp"

namespace aussois {

/// Maps points from A's shape frame, relative to A's centre, to B's shape frame, relative to B's centre.
struct NodeMotion {
  float R[9];  // row by row
  float t[3];
  NodeMotion(const Mat3& rotation, const Vec3& translation) {
    for (int i = 0; i < 3; ++i) {
      t[i] = float(translation[i]);
      for (int j = 0; j < 3; ++j) R[3 * i + j] = float(rotation(i, j));
    }
  }
  AUSSOIS_INLINE void move(const ConeNode& node, ConeNode& out) const {
    const auto turn = [&](const float(&v)[3][4], float(&w)[3][4], bool shift) {
      const V4 x = load4(v);
      for (int i = 0; i < 3; ++i)
        store4(R[3 * i] * x.x + R[3 * i + 1] * x.y + R[3 * i + 2] * x.z + (shift ? t[i] : 0.0F), w[i]);
    };
    turn(node.c, out.c, true);
    turn(node.axis, out.axis, false);
    for (int k = 0; k < 2; ++k) turn(node.u[k], out.u[k], false);
    for (int k = 0; k < 4; ++k) {
      out.r[k] = node.r[k], out.cos[k] = node.cos[k], out.sin[k] = node.sin[k];
      out.child[k] = node.child[k], out.count[k] = node.count[k];
      for (int i = 0; i < 3; ++i) out.h[i][k] = node.h[i][k];
    }
  }
  AUSSOIS_INLINE ConeNode moved(const ConeNode& node) const {
    ConeNode out;
    move(node, out);
    return out;
  }
};

AUSSOIS_INLINE int children_of(const ConeNode& node) {  // bits of the lanes in use
  return bits(load4(node.r) >= 0);
}

/// One child of a node.
struct ConeSlot {
  const ConeNode* node;
  int lane;
  int first() const { return int(node->child[lane]); }
  int count() const { return int(node->count[lane]); }
};

/// Number of parts that the descent of a pair of trees is cut into.
inline constexpr int kDescentParts = 16;

/// A Test has near(four children, slot, slot_is_a) -> bits of the children that can matter to the slot; A's
/// side comes in B's frame. open(bucket of A) is called before buckets(bucket of A, bucket of B), which is
/// called for each pair that is left.
template <class Test>
class DualDescent {
 public:
  DualDescent(const ConeTree& a, const ConeTree& b, const NodeMotion& motion, Test& test)
      : a_(a), b_(b), motion_(motion), test_(test) {}

  /// Parts 0 to kDescentParts - 1 are the grandchildren of A's root. `any_machine`: use only instructions
  /// that every machine has; the result is the same.
  void run(int part, bool any_machine = false) {
    if (a_.nodes.empty() || b_.nodes.empty()) return;
    if (has_avx2() && !any_machine)
      run_avx2(part);
    else
      run_here(part);
  }
  /// All parts, one after the other.
  void run_all(bool any_machine = false) {
    if (a_.nodes.empty() || b_.nodes.empty()) return;
    if (has_avx2() && !any_machine)
      run_all_avx2();
    else
      run_all_here();
  }

 private:
  using Entry = std::uint32_t;  // node and lane of B

  // A node of A in B's frame, and the part of the list that matters to it, with the lanes it matters to.
  struct Level {
    ConeNode node;
    std::size_t begin, end, masks;
    int next;  // lane
  };

  AUSSOIS_AVX2 void run_avx2(int part) { run_here(part); }
  AUSSOIS_AVX2 void run_all_avx2() { run_all_here(); }

  AUSSOIS_INLINE void run_all_here() {
    const ConeNode root = motion_.moved(a_.nodes[0]);
    for (int lane = 0; lane < 4; ++lane) {
      if (!(children_of(root) >> lane & 1)) continue;
      if (root.count[lane] > 0) {  // a bucket
        descend({&root, lane});
        continue;
      }
      const ConeNode child = motion_.moved(a_.nodes[root.child[lane]]);
      for (int k = 0; k < 4; ++k)
        if (children_of(child) >> k & 1) descend({&child, k});
    }
  }

  AUSSOIS_INLINE void run_here(int part) {
    const ConeNode root = motion_.moved(a_.nodes[0]);
    const int lane = part / 4;
    if (!(children_of(root) >> lane & 1)) return;
    if (root.count[lane] > 0) {  // a bucket
      if (part % 4 == 0) descend({&root, lane});
      return;
    }
    const ConeNode child = motion_.moved(a_.nodes[root.child[lane]]);
    if (children_of(child) >> (part % 4) & 1) descend({&child, part % 4});
  }

  AUSSOIS_INLINE ConeSlot slot(Entry e) const { return {&b_.nodes[e / 4], int(e % 4)}; }

  // A fine mesh has more nodes than the second-level cache holds. Prefetching those that will be opened saves
  // an eighth of the time there.
  AUSSOIS_INLINE static void prefetch(const ConeTree& tree, const ConeNode& four, int lane) {
    if (four.count[lane] > 0) return;  // a bucket
    const char* node = reinterpret_cast<const char*>(&tree.nodes[four.child[lane]]);
    for (std::size_t line = 0; line < sizeof(ConeNode); line += 64) __builtin_prefetch(node + line);
  }

  AUSSOIS_INLINE void push(std::uint32_t node, const ConeSlot& a) {
    const ConeNode& four = b_.nodes[node];
    const int lanes = children_of(four) & test_.near(four, a, true);
    make_room(4);
    for (std::uint32_t k = 0; k < 4; ++k) {
      append(4 * node + k, lanes >> k & 1);
      if (lanes >> k & 1) prefetch(b_, four, int(k));
    }
  }

  // The list is written without a branch: which entry matters is hard to predict.
  AUSSOIS_INLINE void make_room(std::size_t entries) {
    if (list_.size() < size_ + entries) list_.resize(2 * (size_ + entries));
  }
  AUSSOIS_INLINE void append(Entry entry, int matters) {
    list_[size_] = entry;
    size_ += std::size_t(matters);
  }

  AUSSOIS_INLINE void descend(const ConeSlot& top) {
    size_ = 0;
    depth_ = 0;
    push(0, top);
    ConeSlot a = top;
    std::size_t begin = 0;  // the list from here on holds the nodes of B that matter to `a`
    for (;;) {
      enter(a, begin);
      for (;;) {  // on to the next child with a list that is not empty
        if (depth_ == 0) return;
        Level& level = levels_[depth_ - 1];
        if (level.next == 4) {
          size_ = level.begin;
          --depth_;
          continue;
        }
        const int lane = level.next++;
        size_ = level.end;
        make_room(level.end - level.begin);
        const char* const mask = masks_.data() + level.masks;
        for (std::size_t i = level.begin; i < level.end; ++i)
          append(list_[i], mask[i - level.begin] >> lane & 1);
        if (size_ == level.end) continue;
        a = {&level.node, lane};
        begin = level.end;
        break;
      }
    }
  }

  // Opens the nodes of B that are larger than A's slot; then looks at the buckets, or opens the slot.
  AUSSOIS_INLINE void enter(const ConeSlot& a, std::size_t begin) {
    const bool at_bucket = a.count() > 0;
    for (std::size_t i = begin; i < size_;) {
      const ConeSlot b = slot(list_[i]);
      if (b.count() > 0 || (!at_bucket && b.node->r[b.lane] < a.node->r[a.lane])) {
        ++i;
        continue;
      }
      const std::uint32_t node = b.node->child[b.lane];
      list_[i] = list_[--size_];
      push(node, a);
    }
    if (size_ == begin) return;
    if (at_bucket) {
      test_.open(a);
      for (std::size_t i = begin; i < size_; ++i) test_.buckets(a, slot(list_[i]));
      return;
    }
    const ConeNode& below = a_.nodes[a.first()];
    Level& level = levels_[depth_++];
    level.begin = begin, level.end = size_, level.next = 0;
    level.masks =
        depth_ > 1 ? levels_[depth_ - 2].masks + levels_[depth_ - 2].end - levels_[depth_ - 2].begin : 0;
    motion_.move(below, level.node);
    const ConeNode& node = level.node;
    const int there = children_of(node);
    for (int lane = 0; lane < 4; ++lane)
      if (there >> lane & 1) prefetch(a_, node, lane);
    if (masks_.size() < level.masks + size_ - begin) masks_.resize(2 * (level.masks + size_ - begin));
    char* const mask = masks_.data() + level.masks;
    for (std::size_t i = begin; i < size_; ++i)
      mask[i - begin] = char(there & test_.near(node, slot(list_[i]), false));
  }

  const ConeTree &a_, &b_;
  const NodeMotion& motion_;
  Test& test_;
  std::vector<Entry> list_{};  // in use: the first size_
  std::size_t size_ = 0;
  std::vector<char> masks_{};
  std::array<Level, 17>
      levels_;  // all children but the last are full, and 4^16 buckets are more than an int counts
  std::size_t depth_ = 0;
};

/// How far two things stay apart along an axis, on which their centres are `t` apart, and `t + s` at the end.
template <bool kMoving>
AUSSOIS_INLINE F4 apart4(F4 t, F4 s) {
  if constexpr (!kMoving) return abs4(t);
  const F4 towards = t < 0 ? -s : s;
  return abs4(t) + (towards < 0 ? towards : splat(0));
}

/// Mask of the children in `still` whose boxes may come within `reach` of the slot's box while d, from the
/// slot to the four, goes on to d + shift. Tests separating axes: the three of each box, then the nine cross
/// products, which cost more.
template <bool kMoving>
AUSSOIS_INLINE I4 boxes_near(const ConeNode& four, const ConeSlot& one, const V4& d, const V4& shift,
                             F4 reach, I4 still) {
  V4 u[3], w[3];
  F4 hu[3], hw[3];
  for (int k = 0; k < 2; ++k) {
    u[k] = spread(one.node->u[k], one.lane);
    w[k] = load4(four.u[k]);
  }
  u[2] = cross(u[0], u[1]);
  w[2] = cross(w[0], w[1]);
  for (int k = 0; k < 3; ++k) {
    hu[k] = splat(one.node->h[k][one.lane]);
    hw[k] = load4(four.h[k]);
  }
  F4 R[3][3], Q[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R[i][j] = dot(u[i], w[j]), Q[i][j] = abs4(R[i][j]);
  F4 t[3], s[3];
  for (int i = 0; i < 3; ++i) {
    t[i] = dot(d, u[i]), s[i] = dot(shift, u[i]);
    still &=
        apart4<kMoving>(t[i], s[i]) - hu[i] - hw[0] * Q[i][0] - hw[1] * Q[i][1] - hw[2] * Q[i][2] <= reach;
  }
  for (int j = 0; j < 3; ++j)
    still &= apart4<kMoving>(dot(d, w[j]), dot(shift, w[j])) - hw[j] - hu[0] * Q[0][j] - hu[1] * Q[1][j] -
                 hu[2] * Q[2][j] <=
             reach;
  if (!bits(still)) return still;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const F4 gap =
          apart4<kMoving>(t[i2] * R[i1][j] - t[i1] * R[i2][j], s[i2] * R[i1][j] - s[i1] * R[i2][j]) -
          hu[i1] * Q[i2][j] - hu[i2] * Q[i1][j] - hw[j1] * Q[i][j2] - hw[j2] * Q[i][j1];
      still &= gap <= reach;  // the axis is at most a unit vector: this errs on the safe side
    }
  return still;
}

/// The same where nothing moves.
AUSSOIS_INLINE I4 boxes_near(const ConeNode& four, const ConeSlot& one, const V4& d, F4 reach, I4 still) {
  return boxes_near<false>(four, one, d, V4{}, reach, still);
}

}  // namespace aussois
