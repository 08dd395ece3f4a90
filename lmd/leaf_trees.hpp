// SPDX-License-Identifier: Apache-2.0
// The trees over the leaves of a shape, and the lanes of their buckets that a descent used last.
#pragma once

#include <vector>

#include "lmd/leaf.hpp"

namespace aussois {

struct TreeOfLeaves {
  const ConeTree* tree;
  LeafId first;
};

/// All that are not empty; the faces of sheets twice, once for each side.
inline std::vector<TreeOfLeaves> trees_of(const LmdShape& s) {
  std::vector<TreeOfLeaves> all{{&s.vertex_tree, {0, 0, 1}},
                                {&s.wide_vertex_tree, {s.narrow_vertices, 0, 1}},
                                {&s.edge_tree, {0, 1, 1}},
                                {&s.wide_edge_tree, {s.narrow_edges, 1, 1}},
                                {&s.face_tree, {0, 2, 1}}};
  if (!s.complex.solid) all.push_back({&s.face_tree, {0, 2, -1}});
  std::erase_if(all, [](const TreeOfLeaves& t) { return t.tree->nodes.empty(); });
  return all;
}

/// Lanes of the buckets of B last used: neighbouring buckets of A need the same ones.
template <class Lanes>
class RecentLanes {
 public:
  template <class Load>
  const Lanes& get(int first, const Load& load) {
    if (lanes_.empty()) lanes_.resize(kSize), first_.resize(kSize, -1);
    const std::size_t at = std::size_t(first / kBucket) % kSize;
    if (first_[at] != first) first_[at] = first, lanes_[at] = load();
    return lanes_[at];
  }

 private:
  static constexpr std::size_t kSize = 64;
  std::vector<Lanes> lanes_{};
  std::vector<int> first_{};
};

}  // namespace aussois
