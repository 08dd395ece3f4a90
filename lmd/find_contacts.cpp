// SPDX-License-Identifier: Apache-2.0
#include "lmd/find_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "lmd/dual_traversal.hpp"
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
           .tolerance = 2e-9 * size}};  // 1e-9 of the larger box diagonal
}

struct Found {
  int a = 0, b = 0;  // leaves
  LocalMinimum minimum{};
};

// Kernels accept feet that are off by a length, nodes prune by angles: at a distance d the length is worth tau / d.
double angle_slack(const MinimumCriteria& c, double dilation, double size) {
  return 1e-6 + c.tolerance / std::max(dilation / 2, 1e-3 * size);  // [rad]; 1e-6 for rounding of cones and poses
}

// cos and sin of an angle in [0, pi]; sums keep `past_pi` once they leave it, since then nothing is outside.
struct Angle {
  double cos = 1, sin = 0;
  bool past_pi = false;
};

Angle operator+(const Angle& a, const Angle& b) {
  const double sin = a.sin * b.cos + a.cos * b.sin;
  return {a.cos * b.cos - a.sin * b.sin, sin, a.past_pi || b.past_pi || sin < 0};
}

Angle angle_of(double value) {
  return {std::cos(value), std::sin(value), value >= kPi};
}

Angle cap_of(const BvhNode& node) {
  return {node.cos_half_angle, node.sin_half_angle, node.half_angle >= kPi};
}

// Everything of a traversal that is the same for all pairs of nodes.
struct NodeTests {
  explicit NodeTests(const Pair& pair)
      : NodeTests(pair, angle_slack(pair.criteria, pair.a->radius + pair.b->radius,
                                    std::max(pair.a->bounding_radius, pair.b->bounding_radius))) {}
  NodeTests(const Pair& pair, double slack)
      : a_nodes(pair.a->bvh.nodes.data()),
        reach(pair.criteria.max_distance * (1 + 1e-12)),
        alpha(angle_of(pair.criteria.alpha + slack)),
        alpha_ee(angle_of(std::max(pair.criteria.alpha, pair.criteria.alpha_ee) + slack)),
        none(angle_of(slack)) {
    for (const BvhNode& node : pair.a->bvh.nodes) {  // once each, not once per pair
      centre.push_back(pair.R * node.centre + pair.t);
      axis.push_back(pair.R * node.axis);
    }
  }
  // The enlargement that a node's direction cone needs against a set of partners.
  const Angle& enlargement(std::uint32_t own, std::uint32_t other) const {
    if ((own & kEdgeClasses) && (other & kEdgeClasses)) return alpha_ee;
    return own & kVertexClasses ? alpha : none;
  }
  const BvhNode* a_nodes;
  double reach;
  Angle alpha, alpha_ee, none;
  std::vector<Vec3> centre{}, axis{};  // of A's nodes in B's frame
};

// Is the angle between the two unit vectors larger?
bool outside(const Vec3& axis, const Vec3& direction, const Angle& angle) {
  return !angle.past_pi && axis.dot(direction) < angle.cos;
}

// The tests of (LMD-9), cheap to dear: classes, balls, opposing cones, direction against each cone.
bool can_meet(const NodeTests& tests, const BvhNode& n, const BvhNode& m) {
  if ((partners_of(n.classes) & m.classes) == 0) return false;
  const auto i = std::size_t(&n - tests.a_nodes);
  const Vec3 c = m.centre - tests.centre[i];
  const double both = n.radius + m.radius, limit = both + tests.reach, square = c.squaredNorm();
  if (square > limit * limit) return false;
  const Angle cap_n = cap_of(n), cap_m = cap_of(m);
  const Vec3& axis = tests.axis[i];
  if (outside(axis, -m.axis, cap_n + cap_m + tests.alpha)) return false;
  if (square <= both * both) return true;
  const double distance = std::sqrt(square), sin_phi = both / distance;
  const Angle phi{std::sqrt(1 - sin_phi * sin_phi), sin_phi};
  const Vec3 u = c / distance;
  return !outside(axis, u, cap_n + phi + tests.enlargement(n.classes, m.classes)) &&
         !outside(m.axis, -u, cap_m + phi + tests.enlargement(m.classes, n.classes));
}

// What one part of the traversal collects.
struct Part {
  std::vector<Found> found{};
  LmdStatistics count{};
};

void test_leaves(const Pair& pair, int a, int b, Part& part) {
  const Leaf &leaf_a = pair.a->leaves[std::size_t(a)], &leaf_b = pair.b->leaves[std::size_t(b)];
  if ((partners_of(bit_of(leaf_a.simplex_class)) & bit_of(leaf_b.simplex_class)) == 0) return;
  ++part.count.leaf_pairs;
  if (const auto minimum = test_minimum(leaf_a, leaf_b, pair.R, pair.t, pair.criteria))
    part.found.push_back({a, b, *minimum});
}

Part joined(const std::vector<Part>& parts) {
  Part all;
  for (const Part& part : parts) {
    all.found.insert(all.found.end(), part.found.begin(), part.found.end());
    all.count.node_pairs += part.count.node_pairs;
    all.count.leaf_pairs += part.count.leaf_pairs;
  }
  all.count.minima = long(all.found.size());
  return all;
}

// Inclusive tests can only find a minimum twice. Of those at one place the highest dimensions stay, then the
// smallest ids: what stays is a function of the pose alone (LMD-10).
void merge_duplicates(const Pair& pair, std::vector<Found>& found) {
  const auto rank = [&](const Found& f) {
    const Leaf &a = pair.a->leaves[std::size_t(f.a)], &b = pair.b->leaves[std::size_t(f.b)];
    return std::tuple(-(a.dim + b.dim), a.dim, a.simplex, b.dim, b.simplex, f.a, f.b);
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

Feature make_feature(const LmdShape& shape, const Leaf& leaf, const Vec3& x, int body) {
  const SimplicialComplex& k = shape.complex;
  Feature f{.body = body, .dim = leaf.dim, .simplex = leaf.simplex, .region = leaf.region, .bary = {1, 0, 0}};
  if (leaf.dim == 1) {  // the edge of the chain that carries the foot
    const Chain& chain = shape.ideal.chains[std::size_t(leaf.simplex)];
    const auto along = [&](std::size_t i) {
      return leaf.direction.dot(k.vertices[std::size_t(chain.vertices[i])] - leaf.x[0]);
    };
    const double s = leaf.direction.dot(x - leaf.x[0]);
    std::size_t i = 0;
    while (i + 2 < chain.vertices.size() && s > along(i + 1)) ++i;
    const double begin = along(i), end = along(i + 1);
    const double r = end > begin ? std::clamp((s - begin) / (end - begin), 0.0, 1.0) : 0;
    f.simplex = chain.edges[i];
    const bool forward = k.edges[std::size_t(f.simplex)][0] == chain.vertices[i];
    f.bary = forward ? std::array<double, 3>{1 - r, r, 0} : std::array<double, 3>{r, 1 - r, 0};
  } else if (leaf.dim == 2) {
    const Vec3 n = (leaf.x[1] - leaf.x[0]).cross(leaf.x[2] - leaf.x[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &p = leaf.x[(i + 1) % 3], &q = leaf.x[(i + 2) % 3];
      f.bary[i] = (q - p).cross(x - p).dot(n) / n.squaredNorm();
    }
  }
  return f;
}

ContactSet to_contacts(const PosedShape& a, const PosedShape& b, const Pair& pair, std::vector<Found> found) {
  merge_duplicates(pair, found);
  ContactSet set;
  for (const Found& f : found) {
    const LocalMinimum& m = f.minimum;
    ContactPoint c;
    c.a = make_feature(*a.shape, a.shape->leaves[std::size_t(f.a)], pair.R.transpose() * (m.x_a - pair.t),
                       a.body);
    c.b = make_feature(*b.shape, b.shape->leaves[std::size_t(f.b)], m.x_b, b.body);
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

ContactSet find_contacts(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                         LmdStatistics* statistics) {
  const Pair pair = make_pair_of(a, b, options);
  const NodeTests tests(pair);
  const auto prune = [&](const BvhNode& n, const BvhNode& m, Part& part) {
    ++part.count.node_pairs;
    return !can_meet(tests, n, m);
  };
  const auto leaf = [&](int i, int j, Part& part) { test_leaves(pair, i, j, part); };
  Part all = joined(traverse_pairs<Part>(a.shape->bvh, b.shape->bvh, options.threads, prune, leaf));
  if (statistics) *statistics = all.count;
  return to_contacts(a, b, pair, std::move(all.found));
}

ContactSet find_contacts_exhaustive(const PosedShape& a, const PosedShape& b, const LmdOptions& options) {
  const Pair pair = make_pair_of(a, b, options);
  Part part;
  for (int i = 0; i < int(a.shape->leaves.size()); ++i)
    for (int j = 0; j < int(b.shape->leaves.size()); ++j) test_leaves(pair, i, j, part);
  return to_contacts(a, b, pair, std::move(part.found));
}

}  // namespace aussois
