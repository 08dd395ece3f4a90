// SPDX-License-Identifier: Apache-2.0
#include "lmd/find_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/settings.hpp"
#include "lmd/pair_search.hpp"

namespace aussois {
namespace {

constexpr double kWindowOfSteps = 8;   // candidates are to last so long, by the motion since the last query
constexpr double kFewestSteps = 3;     // they are not worth keeping for fewer
constexpr double kRoomOfBounds = 1.2;  // of their threshold and angles
// A window of shapes so small may be wider than the threshold, up to this part of the smaller one: their
// candidates stay few, and boxes that slide would be searched in each step.
constexpr std::size_t kFewLeafPairs = 1024;
constexpr double kPartOfSize = 1.0 / 16;
constexpr std::size_t kOftenFound = 64;  // minima, with duplicates: flush faces of two boxes

// Inclusive tests can only find a minimum twice. Of those at one place the highest dimensions stay, then the
// smallest ids: what stays is a function of the pose alone. Each that goes has one that stays at its place
// (LMD-10).
std::vector<FoundMinimum> without_duplicates(const RelativePair& pair,
                                             const std::vector<FoundMinimum>& found) {
  struct Place {
    double x;
    int i;
  };
  struct Rank {
    int minus_dims;
    LeafId a, b;
    int k;  // in `along`
    auto operator<=>(const Rank&) const = default;
  };
  std::vector<Place> along;
  along.reserve(found.size());
  const Vec3 skew(0.48, 0.6, 0.64);  // unit; along an axis many places of parts made by CAD are as far
  for (const FoundMinimum& f : found) along.push_back({skew.dot(f.minimum.x_a), int(along.size())});
  std::ranges::sort(along, {}, &Place::x);
  const int count = int(found.size());
  const double near = 10 * pair.criteria.tolerance;
  const auto at_one_place = [&](int i, int j) {
    const LocalMinimum &m = found[i].minimum, &n = found[j].minimum;
    return (m.x_a - n.x_a).norm() <= near && (m.x_b - n.x_b).norm() <= near;
  };
  enum Fate : char { alone, shares, goes };
  std::vector<Fate> fate(found.size(), alone);
  std::vector<Rank> shared;
  shared.reserve(found.size());
  for (int k = 0; k < count; ++k) {
    const auto [x, i] = along[k];
    for (const int step : {1, -1})
      for (int l = k + step; fate[i] == alone && l >= 0 && l < count && std::abs(along[l].x - x) <= near;
           l += step)
        if (at_one_place(i, along[l].i)) fate[i] = fate[along[l].i] = shares;
  }
  for (int k = 0; k < count; ++k) {
    const int i = along[k].i;
    if (fate[i] == shares) shared.push_back({-(found[i].a.dim + found[i].b.dim), found[i].a, found[i].b, k});
  }
  std::ranges::sort(shared);
  for (const Rank& rank : shared) {
    const auto [x, i] = along[rank.k];
    if (fate[i] == goes) continue;  // what stays instead of it has said so
    for (const int step : {-1, 1})
      for (int l = rank.k + step; l >= 0 && l < count && std::abs(along[l].x - x) <= near; l += step) {
        const int j = along[l].i;
        if (fate[j] == shares && at_one_place(i, j)) fate[j] = goes;
      }
  }
  std::vector<FoundMinimum> kept;
  kept.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    if (fate[i] != goes) kept.push_back(found[i]);
  return kept;
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
Feature edge_of_chain(const LmdShape& shape, int chain, const Vec3& x, BodyId body) {
  const SimplicialComplex& k = shape.complex;
  const EdgeLeaf& leaf = shape.edges[chain];
  const Vec3 &begin = k.vertices[leaf.first], &end = k.vertices[leaf.last];
  const double s = (end - begin).dot(x - begin);
  int at = leaf.first;
  for (int i = 0;; ++i) {
    const int id = leaf.path_length == 1 ? leaf.path : shape.paths[leaf.path + i];
    const auto& edge = k.edges[id];
    const int next = edge[0] == at ? edge[1] : edge[0];
    const double low = (end - begin).dot(k.vertices[at] - begin);
    const double high = (end - begin).dot(k.vertices[next] - begin);
    if (i + 1 < leaf.path_length && s > high) {
      at = next;
      continue;
    }
    const double r = high > low ? std::clamp((s - low) / (high - low), 0.0, 1.0) : 0;
    Feature f{.body = body, .dim = 1, .simplex = id, .region = shape.deforming ? id : chain};
    f.bary = edge[0] == at ? std::array<double, 3>{1 - r, r, 0} : std::array<double, 3>{r, 1 - r, 0};
    return f;
  }
}

Feature make_feature(const LmdShape& shape, LeafId leaf, const Vec3& x, BodyId body) {
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
          .region = shape.triangle_region[t],
          .bary = barycentric(leaf_of(shape, leaf), x)};
}

ContactPoint contact_of(const PosedShape& a, const PosedShape& b, const RelativePair& pair,
                        const FoundMinimum& f) {
  const LocalMinimum& m = f.minimum;
  ContactPoint c;
  c.a = make_feature(*a.shape, f.a, pair.R.transpose() * (m.x_a - pair.t), a.body);
  c.b = make_feature(*b.shape, f.b, m.x_b, b.body);
  c.normal = -(b.g_ws.R * m.direction);
  c.gap = m.distance - a.shape->radius - b.shape->radius;
  c.x_a = b.g_ws * m.x_a - a.shape->radius * c.normal;
  c.x_b = b.g_ws * m.x_b + b.shape->radius * c.normal;
  c.angle_margin = m.angle_margin;
  return c;
}

ContactSet to_contacts(const PosedShape& a, const PosedShape& b, const RelativePair& pair,
                       const std::vector<FoundMinimum>& found) {
  ContactSet set;
  set.points.reserve(found.size());
  if (found.size() == 1) set.points.push_back(contact_of(a, b, pair, found.front()));
  if (found.size() <= 1) return set;
  const std::vector<FoundMinimum> minima = without_duplicates(pair, found);
  // First by dimension and simplex of A, then of B; packed, since most contacts are told apart by them.
  struct Place {
    std::uint64_t a, b;
    std::size_t i;
  };
  const auto packed = [](const Feature& f) { return std::uint64_t(f.dim) << 32 | std::uint32_t(f.simplex); };
  std::vector<ContactPoint> points;
  std::vector<Place> order;
  points.reserve(minima.size());
  order.reserve(minima.size());
  for (const FoundMinimum& f : minima) {
    const ContactPoint& c = points.emplace_back(contact_of(a, b, pair, f));
    order.push_back({packed(c.a), packed(c.b), order.size()});
  }
  std::ranges::sort(order, [&](const Place& p, const Place& q) {
    if (p.a != q.a) return p.a < q.a;
    if (p.b != q.b) return p.b < q.b;
    const FoundMinimum &f = minima[p.i], &g = minima[q.i];
    return std::tie(f.minimum.distance, f.a, f.b) < std::tie(g.minimum.distance, g.a, g.b);
  });
  for (const Place& place : order) set.points.push_back(points[place.i]);
  return set;
}

// Its leaves, but for the second sides of sheets.
std::size_t simplex_count(const LmdShape& s) {
  return s.vertices.size() + s.edges.size() + s.faces.size();
}

bool is_ball(const LmdShape& shape) {
  return shape.complex.vertices.size() == 1;
}

// How far a window may reach for candidates to be worth keeping.
MotionWindow widest_window(const LmdShape& a, const LmdShape& b, const LmdOptions& options) {
  const bool few = simplex_count(a) * simplex_count(b) <= kFewLeafPairs;
  const double size = std::min(a.bounding_radius, b.bounding_radius);
  return {few ? std::max(options.threshold, kPartOfSize * size) : options.threshold, options.alpha};
}

// From one pose of A seen from B to another. Balls look the same however they are turned: where one of the
// two is a ball, the motion of its centre seen from the other says as much, without rotation.
MotionWindow moved_since(const SE3& before, const SE3& now, const LmdShape& a, const LmdShape& b) {
  const double rotation = log_so3((before.R.conjugate() * now.R).normalized()).norm();
  const double displacement = (now * a.centre - before * a.centre).norm() +
                              2 * std::sin(std::min(rotation, kPi) / 2) * a.bounding_radius;
  const double of_ball =
      is_ball(b) ? (inverse(now) * b.centre - inverse(before) * b.centre).norm() : displacement;
  if ((is_ball(a) || is_ball(b)) && of_ball <= displacement) return {of_ball, 0};
  return {displacement, rotation};
}

// Assembles the leaves of B once for all queries of the candidates.
void keep_leaves_of_b(Candidates& candidates) {
  std::vector<LeafId> ids;
  ids.reserve(candidates.pairs.size());
  for (const LeafPair& pair : candidates.pairs) ids.push_back(pair.second);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  candidates.leaves_b.reserve(ids.size());
  for (const LeafId id : ids) candidates.leaves_b.push_back(leaf_of(*candidates.b, id));
  candidates.leaf_b.reserve(candidates.pairs.size());
  for (const LeafPair& pair : candidates.pairs)
    candidates.leaf_b.push_back(int(std::ranges::lower_bound(ids, pair.second) - ids.begin()));
}

ContactSet contacts_among(const Candidates& among, const PosedShape& a, const PosedShape& b,
                          const LmdOptions& options) {
  const RelativePair pair = relative_pair(a, b, options);
  std::vector<FoundMinimum> found;
  found.reserve(std::min(among.pairs.size(), kOftenFound));
  Leaf leaf_a;
  for (std::size_t i = 0; i < among.pairs.size(); ++i) {
    const auto& [id_a, id_b] = among.pairs[i];
    if (i == 0 || id_a != among.pairs[i - 1].first) leaf_a = leaf_of(*a.shape, id_a);
    const Leaf& leaf_b = among.leaves_b[among.leaf_b[i]];
    const auto minimum = test_minimum(leaf_a, leaf_b, pair.R, pair.t, pair.criteria);
    if (minimum) found.push_back({id_a, id_b, *minimum});
  }
  return to_contacts(a, b, pair, found);
}

// The same of two balls, which have one pair of leaves.
ContactSet contacts_of_balls(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  constexpr LeafId kBall{.index = 0, .dim = 0, .side = 1};
  const RelativePair pair = relative_pair(a, b, options);
  const auto minimum =
      test_minimum(leaf_of(*a.shape, kBall), leaf_of(*b.shape, kBall), pair.R, pair.t, pair.criteria);
  ContactSet set;
  if (minimum) set.points.push_back(contact_of(a, b, pair, {kBall, kBall, *minimum}));
  return set;
}

}  // namespace

void describe(SettingVisitor& visit, SearchTests& o) {
  visit.begin("SearchTests");
  visit.toggle({.name = "cones", .what = "test opposing caps of nodes", .changes_nothing = true}, o.cones);
  visit.toggle({.name = "directions",
                .what = "test the direction between nodes against their caps",
                .changes_nothing = true},
               o.directions);
  visit.toggle({.name = "boxes", .what = "test separating axes of nodes", .changes_nothing = true}, o.boxes);
  visit.toggle({.name = "quick", .what = "test leaves in single precision first", .changes_nothing = true},
               o.quick);
  visit.toggle({.name = "instructions",
                .what = "use instructions that not every machine has",
                .changes_nothing = true},
               o.instructions);
}

void describe(SettingVisitor& visit, LmdOptions& o) {
  visit.begin("LmdOptions");
  visit.number({"threshold", "largest gap of a contact", "m", not_negative_range()}, o.threshold);
  visit.number({"alpha", "rotation tolerated at a local minimum", "rad", {0, 0.5}}, o.alpha);
  visit.number({"alpha_ee", "the same for edge against edge", "rad", {0, 1}}, o.alpha_ee);
  visit.count({.name = "threads",
               .what = "number of threads of a search",
               .unit = "",
               .range = range_from(1),
               .changes_nothing = true},
              o.threads);
  visit.group("tests", o.tests);
}

void validate(const LmdOptions& options) {
  check_ranges(options);
  require_field(options.alpha_ee >= options.alpha, "LmdOptions::alpha_ee", options.alpha_ee,
                ("be at least LmdOptions::alpha = " + number_text(options.alpha) + " [rad]").c_str());
}

void validate(const MotionWindow& window) {
  require_field(window.displacement >= 0, "MotionWindow::displacement", window.displacement,
                "not be negative [m]");
  require_field(window.rotation >= 0, "MotionWindow::rotation", window.rotation, "not be negative [rad]");
}

ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         LmdStatistics* statistics) {
  const RelativePair pair = relative_pair(a, b, options);
  const SearchResult all = search_pair(pair, nullptr, options);
  if (statistics) *statistics = all.count;
  return to_contacts(a, b, pair, all.found);
}

Candidates find_candidates(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                           const MotionWindow& window, LmdStatistics* statistics) {
  validate(window);
  const RelativePair pair = relative_pair(a, b, options);
  SearchResult all = search_pair(pair, &window, options);
  if (statistics) *statistics = all.count;
  std::ranges::sort(all.candidates);
  Candidates out{a.shape, b.shape, inverse(b.g_ws) * a.g_ws, window, options, std::move(all.candidates)};
  keep_leaves_of_b(out);
  return out;
}

ContactSet find_contacts(const Candidates& candidates, const PosedShape& a, const PosedShape& b) {
  require(a.shape == candidates.a && b.shape == candidates.b, "the candidates are of other shapes");
  const MotionWindow moved = moved_since(candidates.g_ba, inverse(b.g_ws) * a.g_ws, *a.shape, *b.shape);
  const double size = a.shape->bounding_radius + b.shape->bounding_radius;
  require_field(moved.rotation <= candidates.window.rotation + 1e-12, "rotation since the search",
                moved.rotation, "stay within the window [rad]");
  require_field(moved.displacement <= candidates.window.displacement + 1e-12 * size,
                "displacement since the search", moved.displacement, "stay within the window [m]");
  return contacts_among(candidates, a, b, candidates.options);
}

ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         PairScratch& scratch) {
  if (is_ball(*a.shape) && is_ball(*b.shape)) return contacts_of_balls(a, b, options);
  const SE3 g_ba = inverse(b.g_ws) * a.g_ws;
  const bool again = std::exchange(scratch.asked, true);
  const SE3 before = std::exchange(scratch.g_ba, g_ba);
  Candidates& kept = scratch.candidates;
  const auto within = [](const MotionWindow& motion, const MotionWindow& window) {
    return motion.displacement <= window.displacement && motion.rotation <= window.rotation;
  };
  if (kept.a == a.shape && kept.b == b.shape && options.threshold <= kept.options.threshold &&
      options.alpha <= kept.options.alpha && options.alpha_ee <= kept.options.alpha_ee &&
      within(moved_since(kept.g_ba, g_ba, *a.shape, *b.shape), kept.window))
    return contacts_among(kept, a, b, options);
  const MotionWindow last = moved_since(before, g_ba, *a.shape, *b.shape);
  const MotionWindow widest = widest_window(*a.shape, *b.shape, options);
  const MotionWindow window{
      std::min(kWindowOfSteps * last.displacement + options.threshold / 8, widest.displacement),
      std::min(kWindowOfSteps * last.rotation + options.alpha / 64, widest.rotation)};
  if (!again || !within({kFewestSteps * last.displacement, kFewestSteps * last.rotation}, window)) {
    kept = {};
    return find_contacts(a, b, options);
  }
  LmdOptions more = options;  // bounds of the steps to come may be a little larger
  more.threshold *= kRoomOfBounds;
  more.alpha = std::min(0.5, kRoomOfBounds * options.alpha);
  more.alpha_ee = std::min(1.0, kRoomOfBounds * options.alpha_ee);
  kept = find_candidates(a, b, more, window);
  ContactSet found = contacts_among(kept, a, b, options);
  const std::size_t most = kMostCandidates * (simplex_count(*a.shape) + simplex_count(*b.shape));
  if (kept.pairs.size() > std::max(most, kFewLeafPairs)) kept = {};
  return found;
}

std::size_t bytes_of(const PairScratch& scratch) {
  const Candidates& c = scratch.candidates;
  return c.pairs.capacity() * sizeof(LeafPair) + c.leaves_b.capacity() * sizeof(Leaf) +
         c.leaf_b.capacity() * sizeof(int);
}

ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  const RelativePair pair = relative_pair(a, b, options);
  return to_contacts(a, b, pair, search_exhaustively(pair).found);
}

}  // namespace aussois
