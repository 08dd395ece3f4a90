// SPDX-License-Identifier: Apache-2.0
#include "lmd/pair_search.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"
#include "lmd/dual_descent.hpp"
#include "lmd/leaf_filter.hpp"
#include "lmd/leaf_trees.hpp"
#include "lmd/recent_lanes.hpp"

namespace aussois {
namespace {

struct Frames {
  NodeMotion motion;
  LeafFrame a{}, b{};
  float rounding = 0;  // of lengths in single precision [m]
};

Frames frames_of(const RelativePair& pair) {
  const Vec3 t = pair.R * pair.a->centre + pair.t - pair.b->centre;
  const double size =
      pair.a->bounding_radius + pair.b->bounding_radius + t.norm() + pair.criteria.max_distance;
  return {.motion = NodeMotion(pair.R, t),
          .a = {pair.a, pair.R.cast<float>(), pair.a->centre, t.cast<float>()},
          .b = {pair.b, Eigen::Matrix3f::Identity(), pair.b->centre, Eigen::Vector3f::Zero()},
          .rounding = float(2e-6 * size)};
}

// Two trees to be descended: their classes decide by how much caps are enlarged (LMD-9), (LMD-12).
struct TreePair {
  const ConeTree *a = nullptr, *b = nullptr;
  LeafId first_a{}, first_b{};  // of their leaves
  float shift = 0, reach = 0;   // of the window, of the search [m]
  CapLimits caps{};
  FilterLimits limits{};
};

TreePair tree_pair(const RelativePair& pair, const Frames& frames, const MotionWindow* window,
                   const TreeOfLeaves& a, const TreeOfLeaves& b) {
  const MinimumCriteria& c = pair.criteria;
  const double slack = angle_slack(pair);
  const double turn = window ? window->rotation : 0, shift = window ? window->displacement : 0;
  // seen from A, points of B near A move by at most `shift` and what the rotation adds over the distance
  const double foot = 2 * (shift + turn * (c.max_distance + shift));
  TreePair out{.a = a.tree, .b = b.tree, .first_a = a.first, .first_b = b.first};
  out.shift = float(shift * (1 + 1e-6));
  out.reach = float(c.max_distance) + out.shift + frames.rounding;
  out.caps = cap_limits(pair, a.first, b.first, turn);
  out.limits = {.reach = out.reach,
                .foot = frames.rounding + float(c.tolerance + foot),
                .sin_vertex = float(c.sin_alpha + slack + turn) + 1e-5F,
                .sin_edges = float(c.sin_alpha_ee + slack) + 1e-4F,
                .moving = window != nullptr};
  return out;
}

// The tests of (LMD-9) on nodes, then the quick rejects on buckets, then the exact ones.
class Search {
 public:
  Search(const RelativePair& pair, const Frames& frames, const TreePair& trees, const MotionWindow* window,
         const SearchTests& tests, SearchResult& part)
      : pair_(pair), frames_(frames), trees_(trees), window_(window), tests_(tests), part_(part) {}

  AUSSOIS_INLINE int near(const ConeNode& four, const ConeSlot& one, bool one_is_a) {
    part_.count.node_pairs += 4;
    const V4 d = load4(four.c) - spread(one.node->c, one.lane);
    const F4 both = load4(four.r) + (one.node->r[one.lane] + trees_.shift);
    const F4 square = dot(d, d), limit = both + trees_.reach;
    I4 still = square <= limit * limit;
    if (!bits(still)) return 0;
    if (tests_.cones) still &= caps_oppose(four, one, trees_.caps);
    if (!bits(still)) return 0;
    if (tests_.boxes) still = boxes_near(four, one, d, splat(trees_.reach), still);
    if (!bits(still)) return 0;
    if (tests_.directions) still &= directions_meet(four, one, one_is_a, d, both, square, trees_.caps);
    return bits(still);
  }

  AUSSOIS_INLINE void open(const ConeSlot& a) {
    const int first = trees_.first_a.index + a.first();
    if (trees_.first_a.dim == 0) vertices_ = vertex_lanes(frames_.a, first, a.count());
    if (trees_.first_a.dim == 1) edges_ = edge_lanes(frames_.a, first, a.count());
    if (trees_.first_a.dim == 2) faces_ = face_lanes(frames_.a, first, a.count(), trees_.first_a.side);
  }

  AUSSOIS_INLINE void buckets(const ConeSlot& a, const ConeSlot& b) {
    const int first_b = trees_.first_b.index + b.first(), side_b = trees_.first_b.side;
    const auto edges_of_b = [&]() -> const EdgeLanes& {
      return recent_edges_.get(first_b, [&] { return edge_lanes(frames_.b, first_b, b.count()); });
    };
    const auto faces_of_b = [&]() -> const FaceLanes& {
      return recent_faces_.get(first_b, [&] { return face_lanes(frames_.b, first_b, b.count(), side_b); });
    };
    part_.count.leaf_pairs += a.count() * b.count();
    switch (3 * trees_.first_a.dim + trees_.first_b.dim) {
      case 0:
        return vertices_of_a(a, b, vertices_of(b));
      case 1:
        return vertices_of_a(a, b, edges_of_b());
      case 2:
        return vertices_of_a(a, b, faces_of_b());
      case 3:
        return vertices_of_b(a, b, edges_);
      case 4: {
        const EdgeLanes& lanes = edges_of_b();
        for (int i = 0; i < a.count(); ++i) test(a, i, b, may_touch(edges_, i, lanes, trees_.limits));
        return;
      }
      default:
        return vertices_of_b(a, b, faces_);
    }
  }

 private:
  AUSSOIS_INLINE const VertexLanes& vertices_of(const ConeSlot& b) {
    const int first = trees_.first_b.index + b.first();
    return recent_vertices_.get(first, [&] { return vertex_lanes(frames_.b, first, b.count()); });
  }

  template <class Lanes>
  AUSSOIS_INLINE void vertices_of_a(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes) {
    for (int i = 0; i < a.count(); ++i) {
      const VertexLeaf& v = pair_.a->vertices[trees_.first_a.index + a.first() + i];
      test(a, i, b, may_touch(frames_.a, v, spread(vertices_.p, i), lanes, trees_.limits));
    }
  }

  template <class Lanes>
  AUSSOIS_INLINE void vertices_of_b(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes) {
    const VertexLanes& corners = vertices_of(b);
    for (int j = 0; j < b.count(); ++j) {
      const VertexLeaf& v = pair_.b->vertices[trees_.first_b.index + b.first() + j];
      const int left = may_touch(frames_.b, v, spread(corners.p, j), lanes, trees_.limits);
      for (int i = 0; i < a.count(); ++i)
        if (!tests_.quick || left >> i & 1) test_exactly(a, i, b, 1 << j);
    }
  }

  AUSSOIS_INLINE void test(const ConeSlot& a, int i, const ConeSlot& b, int lanes) {
    if (!tests_.quick) lanes = 0b1111;
    if (lanes != 0) test_exactly(a, i, b, lanes);
  }

  // The exact tests of leaf i of A's bucket against those of B's whose bits are set.
  void test_exactly(const ConeSlot& a, int i, const ConeSlot& b, int lanes) {
    LeafId id_a = trees_.first_a, id_b = trees_.first_b;
    id_a.index += a.first() + i;
    const Leaf leaf_a = window_ ? Leaf{} : leaf_of(*pair_.a, id_a);
    for (int j = 0; j < b.count(); ++j) {
      if (!(lanes >> j & 1)) continue;
      id_b.index = trees_.first_b.index + b.first() + j;
      if (!may_meet(pair_, id_a, id_b)) continue;
      if (window_) {
        part_.candidates.emplace_back(id_a, id_b);
        continue;
      }
      ++part_.count.exact_tests;
      const auto minimum = test_minimum(leaf_a, leaf_of(*pair_.b, id_b), pair_.R, pair_.t, pair_.criteria);
      if (minimum) part_.found.push_back({id_a, id_b, *minimum});
    }
  }

  const RelativePair& pair_;
  const Frames& frames_;
  const TreePair& trees_;
  const MotionWindow* window_;
  const SearchTests& tests_;
  SearchResult& part_;
  VertexLanes vertices_{};  // of A's open bucket
  EdgeLanes edges_{};
  FaceLanes faces_{};
  RecentLanes<VertexLanes> recent_vertices_{};
  RecentLanes<EdgeLanes> recent_edges_{};
  RecentLanes<FaceLanes> recent_faces_{};
};

SearchResult joined(const std::vector<SearchResult>& parts) {
  SearchResult all;
  for (const SearchResult& part : parts) {
    all.found.insert(all.found.end(), part.found.begin(), part.found.end());
    all.candidates.insert(all.candidates.end(), part.candidates.begin(), part.candidates.end());
    all.count.node_pairs += part.count.node_pairs;
    all.count.leaf_pairs += part.count.leaf_pairs;
    all.count.exact_tests += part.count.exact_tests;
  }
  all.count.minima = long(all.found.size());
  return all;
}

constexpr long kFewLeafPairs = 2;  // balls: looked at sooner than the trees are

long leaf_count(const LmdShape& s) {
  return long(s.vertices.size() + s.edges.size() + (s.complex.solid ? 1 : 2) * s.faces.size());
}

std::vector<LeafId> leaves_of(const LmdShape& s) {
  std::vector<LeafId> ids;
  ids.reserve(leaf_count(s));
  for (int i = 0; i < int(s.vertices.size()); ++i) ids.push_back({i, 0, 1});
  for (int i = 0; i < int(s.edges.size()); ++i) ids.push_back({i, 1, 1});
  for (const int side : {1, -1})
    for (int i = 0; i < int(s.faces.size()) && (side == 1 || !s.complex.solid); ++i)
      ids.push_back({i, 2, std::int8_t(side)});
  return ids;
}

}  // namespace

RelativePair relative_pair(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  const MaterialNeighbours* self = self_of(*a.shape, a.body, b.body);
  const SE3 g = self ? SE3{} : inverse(b.g_ws) * a.g_ws;
  const double size = std::max(a.shape->bounding_radius, b.shape->bounding_radius);
  return {a.shape,
          b.shape,
          g.R.toRotationMatrix(),
          g.p,
          {.max_distance = a.shape->radius + b.shape->radius + options.threshold,
           .alpha = options.alpha,
           .alpha_ee = options.alpha_ee,
           .tolerance = 2e-9 * size,  // 1e-9 of the larger box diagonal
           .sin_alpha = std::sin(options.alpha),
           .sin_alpha_ee = std::sin(options.alpha_ee)},
          self};
}

bool may_meet(const RelativePair& pair, LeafId a, LeafId b) {
  return !pair.self || meet(*pair.self, corners_of(*pair.a, a), corners_of(*pair.b, b));
}

double angle_slack(const RelativePair& pair) {
  const double dilation = pair.a->radius + pair.b->radius;
  const double size = std::max(pair.a->bounding_radius, pair.b->bounding_radius);
  return 1e-6 + pair.criteria.tolerance / std::max(dilation / 2, 1e-3 * size);  // 1e-6 for rounding of poses
}

SearchResult search_exhaustively(const RelativePair& pair) {
  SearchResult all;
  const std::vector<LeafId> all_b = leaves_of(*pair.b);
  std::vector<Leaf> leaves_b;
  leaves_b.reserve(all_b.size());
  for (LeafId id : all_b) leaves_b.push_back(leaf_of(*pair.b, id));
  for (LeafId id : leaves_of(*pair.a)) {
    const Leaf leaf = leaf_of(*pair.a, id);
    for (std::size_t j = 0; j < all_b.size(); ++j) {
      if (!can_touch(id.dim, all_b[j].dim) || !may_meet(pair, id, all_b[j])) continue;
      ++all.count.exact_tests;
      if (const auto minimum = test_minimum(leaf, leaves_b[j], pair.R, pair.t, pair.criteria))
        all.found.push_back({id, all_b[j], *minimum});
    }
  }
  all.count.minima = long(all.found.size());
  return all;
}

SearchResult search_pair(const RelativePair& pair, const MotionWindow* window, const LmdOptions& options) {
  if (!window && leaf_count(*pair.a) * leaf_count(*pair.b) <= kFewLeafPairs) return search_exhaustively(pair);
  const Frames frames = frames_of(pair);
  std::vector<TreePair> trees;
  for (const TreeOfLeaves& a : trees_of(*pair.a))
    for (const TreeOfLeaves& b : trees_of(*pair.b))
      if (can_touch(a.first.dim, b.first.dim)) trees.push_back(tree_pair(pair, frames, window, a, b));
  if (options.threads == 1) {  // the same in the same order; small shapes are not worth so many parts
    SearchResult all;
    for (const TreePair& pair_of_trees : trees) {
      Search tests(pair, frames, pair_of_trees, window, options.tests, all);
      DualDescent<Search>(*pair_of_trees.a, *pair_of_trees.b, frames.motion, tests)
          .run_all(!options.tests.instructions);
    }
    all.count.minima = long(all.found.size());
    return all;
  }
  std::vector<SearchResult> parts(trees.size() * kDescentParts);
  parallel_for(int(parts.size()), options.threads, [&](int i) {
    const TreePair& pair_of_trees = trees[std::size_t(i) / kDescentParts];
    Search tests(pair, frames, pair_of_trees, window, options.tests, parts[i]);
    DualDescent<Search>(*pair_of_trees.a, *pair_of_trees.b, frames.motion, tests)
        .run(i % kDescentParts, !options.tests.instructions);
  });
  return joined(parts);
}

}  // namespace aussois
