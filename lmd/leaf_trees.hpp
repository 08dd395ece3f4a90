// SPDX-License-Identifier: Apache-2.0
// The trees over the leaves of a shape, as a descent meets them.
#pragma once

#include <algorithm>
#include <vector>

#include "lmd/cone_tests.hpp"
#include "lmd/pair_search.hpp"

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

/// By how much the caps of two trees are enlarged if A turns by `turn` at most and B rests (LMD-9), (LMD-12)
/// [rad].
inline CapLimits cap_limits(const RelativePair& pair, LeafId a, LeafId b, double turn) {
  const MinimumCriteria& c = pair.criteria;
  const double slack = angle_slack(pair);
  const double edges = a.dim == 1 && b.dim == 1 ? std::max(c.alpha, c.alpha_ee) : 0;
  return {.opposing = angle_of(c.alpha + slack + turn),
          .enlarged_a = angle_of(slack + turn + (a.dim == 0 ? c.alpha : edges)),
          .enlarged_b = angle_of(slack + (b.dim == 0 ? c.alpha : edges)),
          .side_a = float(a.side),
          .side_b = float(b.side)};
}

}  // namespace aussois
