// SPDX-License-Identifier: Apache-2.0
// Descends two hierarchies at once. The work is cut into the same parts for any number of threads; each part
// collects its own findings, returned in a fixed order.
#pragma once

#include <utility>
#include <vector>

#include "geometry/parallel.hpp"
#include "lmd/normal_cone_bvh.hpp"

namespace aussois {

/// prune(node_a, node_b, part) -> true if nothing below can matter; leaf(item_a, item_b, part) looks at two
/// items.
template <class Part, class Prune, class AtLeaf>
std::vector<Part> traverse_pairs(const NormalConeBvh& a, const NormalConeBvh& b, int threads,
                                 const Prune& prune, const AtLeaf& leaf) {
  constexpr int kParts = 64;
  using NodePair = std::pair<int, int>;
  const auto descend = [&](NodePair at, std::vector<NodePair>& below, Part& part) {
    const BvhNode &n = a.nodes[std::size_t(at.first)], &m = b.nodes[std::size_t(at.second)];
    if (prune(n, m, part)) return;
    if (n.count > 0 && m.count > 0) {
      for (int i = n.first; i < n.first + n.count; ++i)
        for (int j = m.first; j < m.first + m.count; ++j)
          leaf(a.items[std::size_t(i)], b.items[std::size_t(j)], part);
    } else if (m.count > 0 || (n.count == 0 && n.radius >= m.radius)) {  // open the larger ball
      below.push_back({n.first, at.second});
      below.push_back({n.first + 1, at.second});
    } else {
      below.push_back({at.first, m.first});
      below.push_back({at.first, m.first + 1});
    }
  };

  std::vector<Part> parts(1);
  std::vector<NodePair> front;
  if (!a.nodes.empty() && !b.nodes.empty()) front.push_back({0, 0});
  while (!front.empty() && int(front.size()) < kParts) {  // breadth first until there is enough to share
    std::vector<NodePair> next;
    for (const NodePair& at : front) descend(at, next, parts[0]);
    front = std::move(next);
  }
  parts.resize(1 + front.size());
  parallel_for(int(front.size()), threads, [&](int i) {
    std::vector<NodePair> stack{front[std::size_t(i)]};
    while (!stack.empty()) {
      const NodePair at = stack.back();
      stack.pop_back();
      descend(at, stack, parts[std::size_t(i) + 1]);
    }
  });
  return parts;
}

}  // namespace aussois
