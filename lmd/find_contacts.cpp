// SPDX-License-Identifier: Apache-2.0
#include "lmd/find_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "lmd/dual_descent.hpp"
#include "lmd/leaf_filter.hpp"
#include "lmd/minimum_test.hpp"

namespace aussois {
namespace {

// The pair as the tests see it: A's frame mapped to B's.
struct Pair {
  const LmdShape *a, *b;
  Mat3 R;
  Vec3 t;
  MinimumCriteria criteria;
};

Pair make_pair_of(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  const SE3 g = inverse(b.g_ws) * a.g_ws;
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
           .sin_alpha_ee = std::sin(options.alpha_ee)}};
}

struct Found {
  LeafId a{}, b{};
  LocalMinimum minimum{};
};

// Kernels accept feet that are off by a length, nodes prune by angles: at a distance d the length is worth
// tau / d.
double angle_slack(const Pair& pair) {
  const double dilation = pair.a->radius + pair.b->radius;
  const double size = std::max(pair.a->bounding_radius, pair.b->bounding_radius);
  return 1e-6 + pair.criteria.tolerance / std::max(dilation / 2, 1e-3 * size);  // 1e-6 for rounding of poses
}

// cos and sin of an angle in [0, pi].
struct Angle {
  float cos = 1, sin = 0;
};

Angle angle_of(double value) {
  return {float(std::cos(std::min(value, kPi))), float(std::sin(std::min(value, kPi)))};
}

constexpr float kRounding = 2e-6F;  // of sums and products of cosines in single precision

// Are the directions at most the sum of the angles apart, given the cosine between them? A sum beyond pi,
// where its sine is negative, is always enough.
I4 within(F4 cos_between, F4 cos_a, F4 sin_a, F4 cos_b, F4 sin_b) {
  const F4 cos = cos_a * cos_b - sin_a * sin_b, sin = sin_a * cos_b + cos_a * sin_b;
  return (sin <= 0) | (cos_between + kRounding >= cos);
}

// Two trees to be descended: their classes decide by how much caps are enlarged (LMD-9).
struct TreePair {
  const ConeTree *a, *b;
  LeafId first_a{}, first_b{};  // of their leaves
};

// What one part of the search collects.
struct Part {
  std::vector<Found> found{};
  std::vector<std::pair<LeafId, LeafId>> candidates{};  // instead, of a search for a window
  LmdStatistics count{};
};

struct Frames {
  NodeMotion motion{};
  LeafFrame a{}, b{};
  float rounding = 0;  // of lengths in single precision [m]
};

Frames frames_of(const Pair& pair) {
  Frames out;
  const Eigen::Matrix3f R = pair.R.cast<float>();
  const Vec3 t = pair.R * pair.a->centre + pair.t - pair.b->centre;
  out.a = {pair.a, R, pair.a->centre, t.cast<float>()};
  out.b = {pair.b, Eigen::Matrix3f::Identity(), pair.b->centre, Eigen::Vector3f::Zero()};
  for (int i = 0; i < 3; ++i) {
    out.motion.t[i] = float(t[i]);
    for (int j = 0; j < 3; ++j) out.motion.R[3 * i + j] = R(i, j);
  }
  out.rounding = float(
      2e-6 * (pair.a->bounding_radius + pair.b->bounding_radius + t.norm() + pair.criteria.max_distance));
  return out;
}

// The tests of (LMD-9) on nodes, then the quick rejects on buckets, then the exact ones.
// Lanes of the buckets of B last used: neighbouring buckets of A ask for the same ones.
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

class Search {
 public:
  Search(const Pair& pair, const Frames& frames, const TreePair& trees, const MotionWindow* window,
         Part& part)
      : pair_(pair), frames_(frames), trees_(trees), window_(window), part_(part) {
    const MinimumCriteria& c = pair.criteria;
    const double slack = angle_slack(pair);
    const double turn = window ? window->rotation : 0, shift = window ? window->displacement : 0;
    shift_ = float(shift * (1 + 1e-6));
    reach_ = float(c.max_distance) + shift_ + frames.rounding;
    opposing_ = angle_of(c.alpha + slack + turn);
    const bool edges = trees.first_a.dim == 1 && trees.first_b.dim == 1;
    const double more = edges ? std::max(c.alpha, c.alpha_ee) : 0;
    enlarged_a_ =
        angle_of(slack + turn + (trees.first_a.dim == 0 ? c.alpha : more));  // B's frame stands still
    enlarged_b_ = angle_of(slack + (trees.first_b.dim == 0 ? c.alpha : more));
    side_ = float(trees.first_a.side * trees.first_b.side);
    // seen from A, points of B near A move by at most `shift` and what the rotation adds over the distance
    const double foot = 2 * (shift + turn * (c.max_distance + shift));
    limits_ = {.reach = reach_,
               .foot = frames.rounding + float(c.tolerance + foot),
               .sin_vertex = float(c.sin_alpha + slack + turn) + 1e-5F,
               .sin_edges = float(c.sin_alpha_ee + slack) + 1e-4F,
               .moving = window != nullptr};
  }

  int near(const ConeNode& four, const ConeSlot& one, bool one_is_a) {
    part_.count.node_pairs += 4;
    const V4 d = load4(four.c) - spread(one.node->c, one.lane);
    const F4 both = load4(four.r) + (one.node->r[one.lane] + shift_);
    const F4 square = dot(d, d), limit = both + reach_;
    I4 still = square <= limit * limit;
    if (!bits(still)) return 0;
    const V4 axis = load4(four.axis), own = spread(one.node->axis, one.lane);
    const F4 cos = load4(four.cos), sin = load4(four.sin);
    const float own_cos = one.node->cos[one.lane], own_sin = one.node->sin[one.lane];
    // caps enlarged by the half angle of the slot: opposing_ may carry it past pi, then nothing is outside
    const float c = own_cos * opposing_.cos - own_sin * opposing_.sin;
    const float s = own_sin * opposing_.cos + own_cos * opposing_.sin;
    if (s > 0) still &= within(-side_ * dot(axis, own), cos, sin, splat(c), splat(s));
    if (!bits(still)) return 0;
    // the direction from the slot to the four, known up to phi where the balls do not meet
    const F4 inverse = 1.0F / sqrt4(square);
    const F4 sin_phi = both * inverse;
    const I4 meeting = ~(sin_phi < 0.999F);  // also where both are points at one place
    const F4 room = 1.0F - sin_phi * sin_phi;
    const F4 cos_phi = sqrt4(room > 0 ? room : splat(0));
    const Angle& e_one = one_is_a ? enlarged_a_ : enlarged_b_;
    const Angle& e_four = one_is_a ? enlarged_b_ : enlarged_a_;
    const float side_one = one_is_a ? float(trees_.first_a.side) : float(trees_.first_b.side);
    const float side_four = side_ * side_one;
    const float ce = own_cos * e_one.cos - own_sin * e_one.sin,
                se = own_sin * e_one.cos + own_cos * e_one.sin;
    if (se > 0)
      still &= meeting | within(side_one * dot(own, d) * inverse, splat(ce), splat(se), cos_phi, sin_phi);
    const F4 cf = cos * e_four.cos - sin * e_four.sin, sf = sin * e_four.cos + cos * e_four.sin;
    still &= meeting | (sf <= 0) | within(-side_four * dot(axis, d) * inverse, cf, sf, cos_phi, sin_phi);
    if (!bits(still)) return 0;
    return bits(boxes_near(four, one, d, splat(reach_), still));
  }

  void open(const ConeSlot& a) {
    const int first = trees_.first_a.index + a.first();
    if (trees_.first_a.dim == 0) vertices_ = vertex_lanes(frames_.a, first, a.count());
    if (trees_.first_a.dim == 1) edges_ = edge_lanes(frames_.a, first, a.count());
    if (trees_.first_a.dim == 2) faces_ = face_lanes(frames_.a, first, a.count(), trees_.first_a.side);
  }

  void buckets(const ConeSlot& a, const ConeSlot& b) {
    const int first_b = trees_.first_b.index + b.first(), side_b = trees_.first_b.side;
    const auto edges_of_b = [&]() -> const EdgeLanes& {
      return recent_edges_.get(first_b, [&] { return edge_lanes(frames_.b, first_b, b.count()); });
    };
    const auto faces_of_b = [&]() -> const FaceLanes& {
      return recent_faces_.get(first_b, [&] { return face_lanes(frames_.b, first_b, b.count(), side_b); });
    };
    switch (3 * trees_.first_a.dim + trees_.first_b.dim) {
      case 0:
        return vertices_of_a(a, b, vertex_lanes(frames_.b, first_b, b.count()), vertex_vertex);
      case 1:
        return vertices_of_a(a, b, edges_of_b(), vertex_edge);
      case 2:
        return vertices_of_a(a, b, faces_of_b(), vertex_face);
      case 3:
        return vertices_of_b(a, b, edges_, vertex_edge);
      case 4: {
        const EdgeLanes& lanes = edges_of_b();
        for (int i = 0; i < a.count(); ++i) test(a, i, b, edge_edge(edges_, i, lanes, limits_));
        return;
      }
      default:
        return vertices_of_b(a, b, faces_, vertex_face);
    }
  }

 private:
  template <class Lanes, class Filter>
  void vertices_of_a(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes, const Filter& filter) {
    for (int i = 0; i < a.count(); ++i) {
      const VertexLeaf& v = pair_.a->vertices[std::size_t(trees_.first_a.index + a.first() + i)];
      test(a, i, b, filter(frames_.a, v, spread(vertices_.p, i), lanes, limits_));
    }
  }

  template <class Lanes, class Filter>
  void vertices_of_b(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes, const Filter& filter) {
    const VertexLanes corners = vertex_lanes(frames_.b, trees_.first_b.index + b.first(), b.count());
    for (int j = 0; j < b.count(); ++j) {
      const VertexLeaf& v = pair_.b->vertices[std::size_t(trees_.first_b.index + b.first() + j)];
      const int left = filter(frames_.b, v, spread(corners.p, j), lanes, limits_);
      for (int i = 0; i < a.count(); ++i)
        if (left >> i & 1) test(a, i, b, 1 << j);
    }
  }

  // The exact tests of leaf i of A's bucket against those of B's whose bits are set.
  void test(const ConeSlot& a, int i, const ConeSlot& b, int lanes) {
    part_.count.leaf_pairs += b.count();
    if (lanes == 0) return;
    LeafId id_a = trees_.first_a, id_b = trees_.first_b;
    id_a.index += a.first() + i;
    const Leaf leaf_a = window_ ? Leaf{} : leaf_of(*pair_.a, id_a);
    for (int j = 0; j < b.count(); ++j) {
      if (!(lanes >> j & 1)) continue;
      id_b.index = trees_.first_b.index + b.first() + j;
      if (window_) {
        part_.candidates.emplace_back(id_a, id_b);
        continue;
      }
      ++part_.count.exact_tests;
      const auto minimum = test_minimum(leaf_a, leaf_of(*pair_.b, id_b), pair_.R, pair_.t, pair_.criteria);
      if (minimum) part_.found.push_back({id_a, id_b, *minimum});
    }
  }

  const Pair& pair_;
  const Frames& frames_;
  const TreePair& trees_;
  const MotionWindow* window_;
  Part& part_;
  float shift_ = 0, reach_ = 0, side_ = 1;
  Angle opposing_{}, enlarged_a_{}, enlarged_b_{};
  FilterLimits limits_{};
  VertexLanes vertices_{};  // of A's open bucket
  EdgeLanes edges_{};
  FaceLanes faces_{};
  RecentLanes<EdgeLanes> recent_edges_{};
  RecentLanes<FaceLanes> recent_faces_{};
};

struct TreeOfLeaves {
  const ConeTree* tree;
  LeafId first;
};

std::vector<TreeOfLeaves> trees_of(const LmdShape& s) {
  std::vector<TreeOfLeaves> all{{&s.vertex_tree, {0, 0, 1}},
                                {&s.wide_vertex_tree, {s.narrow_vertices, 0, 1}},
                                {&s.edge_tree, {0, 1, 1}},
                                {&s.wide_edge_tree, {s.narrow_edges, 1, 1}},
                                {&s.face_tree, {0, 2, 1}}};
  if (!s.complex.solid) all.push_back({&s.face_tree, {0, 2, -1}});
  std::erase_if(all, [](const TreeOfLeaves& t) { return t.tree->nodes.empty(); });
  return all;
}

Part joined(std::vector<Part> parts) {
  Part all;
  for (const Part& part : parts) {
    all.found.insert(all.found.end(), part.found.begin(), part.found.end());
    all.candidates.insert(all.candidates.end(), part.candidates.begin(), part.candidates.end());
    all.count.node_pairs += part.count.node_pairs;
    all.count.leaf_pairs += part.count.leaf_pairs;
    all.count.exact_tests += part.count.exact_tests;
  }
  all.count.minima = long(all.found.size());
  return all;
}

// With a window: the candidates of all its poses.
Part search(const Pair& pair, const MotionWindow* window, int threads) {
  const Frames frames = frames_of(pair);
  std::vector<TreePair> trees;
  for (const TreeOfLeaves& a : trees_of(*pair.a))
    for (const TreeOfLeaves& b : trees_of(*pair.b))
      if (can_touch(a.first.dim, b.first.dim)) trees.push_back({a.tree, b.tree, a.first, b.first});
  std::vector<Part> parts(trees.size() * kDescentParts);
  parallel_for(int(parts.size()), threads, [&](int i) {
    const TreePair& pair_of_trees = trees[std::size_t(i) / kDescentParts];
    Search tests(pair, frames, pair_of_trees, window, parts[std::size_t(i)]);
    DualDescent<Search>(*pair_of_trees.a, *pair_of_trees.b, frames.motion, tests).run(i % kDescentParts);
  });
  return joined(std::move(parts));
}

// Inclusive tests can only find a minimum twice. Of those at one place the highest dimensions stay, then the
// smallest ids: what stays is a function of the pose alone (LMD-10).
void merge_duplicates(const Pair& pair, std::vector<Found>& found) {
  const auto rank = [&](const Found& f) {
    return std::tuple(-(f.a.dim + f.b.dim), f.a.dim, f.a.index, f.b.dim, f.b.index, f.a.side, f.b.side);
  };
  std::ranges::sort(found, {}, rank);
  std::vector<std::size_t> by_x(found.size());
  for (std::size_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  std::ranges::sort(by_x, [&](std::size_t i, std::size_t j) {
    const double xi = found[i].minimum.x_a.x(), xj = found[j].minimum.x_a.x();
    return xi != xj ? xi < xj : i < j;
  });
  const double near = 10 * pair.criteria.tolerance;
  std::vector<char> dropped(found.size(), 0);
  for (std::size_t i = 0; i < by_x.size(); ++i)
    for (std::size_t j = i + 1; j < by_x.size(); ++j) {
      const LocalMinimum &p = found[by_x[i]].minimum, &q = found[by_x[j]].minimum;
      if (q.x_a.x() - p.x_a.x() > near) break;
      if ((p.x_a - q.x_a).norm() <= near && (p.x_b - q.x_b).norm() <= near)
        dropped[std::max(by_x[i], by_x[j])] = 1;
    }
  std::vector<Found> kept;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!dropped[i]) kept.push_back(found[i]);
  found = std::move(kept);
}

// Barycentric coordinates of x in a triangle.
std::array<double, 3> barycentric(const Leaf& face, const Vec3& x) {
  const Vec3 n = (face.x[1] - face.x[0]).cross(face.x[2] - face.x[0]);
  std::array<double, 3> bary{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = face.x[(i + 1) % 3], &q = face.x[(i + 2) % 3];
    bary[i] = (q - p).cross(x - p).dot(n) / n.squaredNorm();
  }
  return bary;
}

// The edge of a chain that carries the foot x.
Feature edge_of_chain(const LmdShape& shape, int chain, const Vec3& x, int body) {
  const SimplicialComplex& k = shape.complex;
  const EdgeLeaf& leaf = shape.edges[std::size_t(chain)];
  const Vec3 &begin = k.vertices[std::size_t(leaf.first)], &end = k.vertices[std::size_t(leaf.last)];
  const double s = (end - begin).dot(x - begin);
  int at = leaf.first;
  for (int i = 0;; ++i) {
    const int id = leaf.path_length == 1 ? leaf.path : shape.paths[std::size_t(leaf.path + i)];
    const auto& edge = k.edges[std::size_t(id)];
    const int next = edge[0] == at ? edge[1] : edge[0];
    const double low = (end - begin).dot(k.vertices[std::size_t(at)] - begin);
    const double high = (end - begin).dot(k.vertices[std::size_t(next)] - begin);
    if (i + 1 < leaf.path_length && s > high) {
      at = next;
      continue;
    }
    const double r = high > low ? std::clamp((s - low) / (high - low), 0.0, 1.0) : 0;
    Feature f{.body = body, .dim = 1, .simplex = id, .region = chain};
    f.bary = edge[0] == at ? std::array<double, 3>{1 - r, r, 0} : std::array<double, 3>{r, 1 - r, 0};
    return f;
  }
}

Feature make_feature(const LmdShape& shape, LeafId leaf, const Vec3& x, int body) {
  const auto i = std::size_t(leaf.index);
  if (leaf.dim == 0) {
    const int v = shape.vertices[i].vertex;
    return {.body = body, .dim = 0, .simplex = v, .region = v, .bary = {1, 0, 0}};
  }
  if (leaf.dim == 1) return edge_of_chain(shape, leaf.index, x, body);
  const int t = shape.faces[i];
  return {.body = body,
          .dim = 2,
          .simplex = t,
          .region = shape.triangle_region[std::size_t(t)],
          .bary = barycentric(leaf_of(shape, leaf), x)};
}

ContactSet to_contacts(const PosedShape& a, const PosedShape& b, const Pair& pair, std::vector<Found> found) {
  merge_duplicates(pair, found);
  ContactSet set;
  for (const Found& f : found) {
    const LocalMinimum& m = f.minimum;
    ContactPoint c;
    c.a = make_feature(*a.shape, f.a, pair.R.transpose() * (m.x_a - pair.t), a.body);
    c.b = make_feature(*b.shape, f.b, m.x_b, b.body);
    c.normal = -(b.g_ws.R * m.direction);
    c.gap = m.distance - a.shape->radius - b.shape->radius;
    c.x_a = b.g_ws * m.x_a - a.shape->radius * c.normal;
    c.x_b = b.g_ws * m.x_b + b.shape->radius * c.normal;
    c.angle_margin = m.angle_margin;
    set.points.push_back(c);
  }
  std::ranges::sort(set.points, {}, [](const ContactPoint& c) {
    return std::tuple(c.a.body, c.b.body, c.a.dim, c.a.simplex, c.b.dim, c.b.simplex, c.gap, c.x_a.x(),
                      c.x_a.y(), c.x_a.z());
  });
  return set;
}

}  // namespace

void validate(const LmdOptions& options) {
  require_field(std::isfinite(options.threshold) && options.threshold >= 0, "LmdOptions::threshold",
                options.threshold, "be finite and not negative [m]");
  require_field(options.alpha >= 0 && options.alpha <= 0.5, "LmdOptions::alpha", options.alpha,
                "lie in [0, 0.5] rad");
  require_field(options.alpha_ee >= options.alpha && options.alpha_ee <= 1, "LmdOptions::alpha_ee",
                options.alpha_ee, "lie in [alpha, 1] rad");
  require_field(options.threads >= 1, "LmdOptions::threads", options.threads, "be at least 1");
}

void validate(const MotionWindow& window) {
  require_field(window.displacement >= 0, "MotionWindow::displacement", window.displacement,
                "not be negative [m]");
  require_field(window.rotation >= 0, "MotionWindow::rotation", window.rotation, "not be negative [rad]");
}

ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         LmdStatistics* statistics) {
  const Pair pair = make_pair_of(a, b, options);
  Part all = search(pair, nullptr, options.threads);
  if (statistics) *statistics = all.count;
  return to_contacts(a, b, pair, std::move(all.found));
}

Candidates find_candidates(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                           const MotionWindow& window, LmdStatistics* statistics) {
  validate(window);
  const Pair pair = make_pair_of(a, b, options);
  Part all = search(pair, &window, options.threads);
  if (statistics) *statistics = all.count;
  std::ranges::sort(all.candidates);
  return {a.shape, b.shape, inverse(b.g_ws) * a.g_ws, window, options, std::move(all.candidates)};
}

ContactSet find_contacts(const Candidates& candidates, const PosedShape& a, const PosedShape& b) {
  require(a.shape == candidates.a && b.shape == candidates.b, "the candidates are of other shapes");
  const SE3 moved = inverse(b.g_ws) * a.g_ws;
  const double rotation = log_so3((candidates.g_ba.R.conjugate() * moved.R).normalized()).norm();
  const Vec3& centre = a.shape->centre;
  const double displacement = (moved * centre - candidates.g_ba * centre).norm() +
                              2 * std::sin(std::min(rotation, kPi) / 2) * a.shape->bounding_radius;
  const double size = a.shape->bounding_radius + b.shape->bounding_radius;
  require_field(rotation <= candidates.window.rotation + 1e-12, "rotation since the search", rotation,
                "stay within the window [rad]");
  require_field(displacement <= candidates.window.displacement + 1e-12 * size,
                "displacement since the search", displacement, "stay within the window [m]");
  const Pair pair = make_pair_of(a, b, candidates.options);
  std::vector<Found> found;
  for (const auto& [id_a, id_b] : candidates.pairs)
    if (const auto minimum =
            test_minimum(leaf_of(*a.shape, id_a), leaf_of(*b.shape, id_b), pair.R, pair.t, pair.criteria))
      found.push_back({id_a, id_b, *minimum});
  return to_contacts(a, b, pair, std::move(found));
}

ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  const Pair pair = make_pair_of(a, b, options);
  const auto leaves_of = [](const LmdShape& s) {
    std::vector<LeafId> ids;
    for (int i = 0; i < int(s.vertices.size()); ++i) ids.push_back({i, 0, 1});
    for (int i = 0; i < int(s.edges.size()); ++i) ids.push_back({i, 1, 1});
    for (const int side : {1, -1})
      for (int i = 0; i < int(s.faces.size()) && (side == 1 || !s.complex.solid); ++i)
        ids.push_back({i, 2, std::int8_t(side)});
    return ids;
  };
  std::vector<Found> found;
  const std::vector<LeafId> all_b = leaves_of(*b.shape);
  std::vector<Leaf> leaves_b;
  for (LeafId id : all_b) leaves_b.push_back(leaf_of(*b.shape, id));
  for (LeafId id : leaves_of(*a.shape)) {
    const Leaf leaf = leaf_of(*a.shape, id);
    for (std::size_t j = 0; j < all_b.size(); ++j) {
      if (!can_touch(id.dim, all_b[j].dim)) continue;
      if (const auto minimum = test_minimum(leaf, leaves_b[j], pair.R, pair.t, pair.criteria))
        found.push_back({id, all_b[j], *minimum});
    }
  }
  return to_contacts(a, b, pair, std::move(found));
}

}  // namespace aussois
