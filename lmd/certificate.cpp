// SPDX-License-Identifier: Apache-2.0
#include "lmd/certificate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/all_finite.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/settings.hpp"
#include "lmd/dual_descent.hpp"
#include "lmd/material_neighbours.hpp"
#include "lmd/shared_settings.hpp"
#include "lmd/simplex_distance.hpp"
#include "lmd/simplex_motion.hpp"
#include "lmd/step_minima.hpp"

namespace aussois {
namespace {

// A tree over base simplices: all from one number on, or a list of them.
struct BaseTree {
  const LmdShape* shape;
  const ConeTree* tree;
  int first = 0;
  const SharedArray<int>* list = nullptr;

  BaseSimplex simplex(int i) const { return base_simplex(*shape, list ? (*list)[i] : first + i); }
};
BaseTree unproven_tree(const LmdShape& s) {
  return {&s, &s.unproven_tree, 0, &s.unproven};
}
std::array<BaseTree, 2> base_trees(const LmdShape& s) {
  return {{{&s, &s.face_tree}, {&s, &s.rest_tree, int(s.faces.size())}}};
}

// B's base frame: its shape frame moved to its centre. Everything that nodes need, in it.
struct BaseFrames {
  Mat3 R;  // of A's shape frame
  Vec3 t;
  NodeMotion motion;
  double scale;  // of positions [m]
};

BaseFrames base_frames(const MovingShape& a, const MovingShape& b, const Instant& now_a,
                       const Instant& now_b) {
  const Mat3 R = now_b.R.transpose() * now_a.R;
  const Vec3 t = now_b.R.transpose() * (now_a.t - now_b.t) - b.shape->centre;
  const Vec3 centre = R * a.shape->centre + t;
  return {R, t, NodeMotion(R, centre), a.shape->bounding_radius + b.shape->bounding_radius + centre.norm()};
}

// The velocity field of a body in B's base frame, in single precision.
struct NodeVelocity {
  NodeVelocity(const Instant& body, const Instant& frame, const Vec3& frame_centre) {
    const Mat3 to = frame.R.transpose();
    const Vec3 origin = frame.R * frame_centre + frame.t;
    const Vec3 v0 = to * (body.v + body.w.cross(origin - body.centre)), w0 = to * body.w;
    const Vec3 c0 = to * (body.centre - origin);
    v = v0.cast<float>(), w = w0.cast<float>(), centre = c0.cast<float>();
    spin = float(w0.norm());
  }
  V4 at(const V4& x) const {
    return {v[0] + (w[1] * x.z - w[2] * x.y), v[1] + (w[2] * x.x - w[0] * x.z),
            v[2] + (w[0] * x.y - w[1] * x.x)};
  }
  F4 bend(const V4& x) const {
    const V4 arm{x.x - centre[0], x.y - centre[1], x.z - centre[2]};
    return spin * spin * sqrt4(dot(arm, arm));
  }
  Eigen::Vector3f v, w, centre;
  float spin = 0;
};

// Four simplices in single precision: corners now and at the end of the step, were they to move on straight.
struct SimplexLanes {
  V4 now[3], end[3];
  V4 normal;  // unit; zero for edges and points
  V4 centre;
  F4 bend;  // how far straight paths may be off at the end [m]
};

SimplexLanes simplex_lanes(const BaseTree& tree, const Mat3& R, const Vec3& t, const NodeVelocity& velocity,
                           float dt, int first, int count) {
  SimplexLanes out{};
  for (int k = 0; k < 4; ++k) {  // lanes beyond repeat the last, edges and points a corner
    const BaseSimplex s = tree.simplex(first + std::min(k, count - 1));
    for (int i = 0; i < 3; ++i) {
      const Vec3 x = R * tree.shape->complex.vertices[s.vertex[std::min(i, s.dim)]] + t;
      out.now[i].x[k] = float(x.x()), out.now[i].y[k] = float(x.y()), out.now[i].z[k] = float(x.z());
    }
  }
  for (int i = 0; i < 3; ++i) {
    out.end[i] = out.now[i] + splat(dt) * velocity.at(out.now[i]);
    out.centre = out.centre + splat(1.0F / 3) * out.now[i];
    const F4 bend = (0.5F * dt * dt) * velocity.bend(out.now[i]);
    out.bend = bend > out.bend ? bend : out.bend;
  }
  const V4 n = cross(out.now[1] - out.now[0], out.now[2] - out.now[0]);
  const F4 square = dot(n, n);
  out.normal = (square > 0 ? 1.0F / sqrt4(square) : splat(0)) * n;
  return out;
}

// Lanes of q that one of three directions parts from simplex `k` of p by `wanted` all the time: the normals
// and from centre to centre. As `separation`, with room for rounding in `wanted`.
int parted(const SimplexLanes& p, int k, const SimplexLanes& q, float wanted) {
  V4 now[3], end[3];
  for (int i = 0; i < 3; ++i) now[i] = spread(p.now[i], k), end[i] = spread(p.end[i], k);
  const V4 between = q.centre - spread(p.centre, k);
  const F4 size = sqrt4(dot(between, between));
  const F4 bend = q.bend + p.bend[k];
  I4 apart = {0, 0, 0, 0};
  for (const V4& n : {spread(p.normal, k), q.normal, (1.0F / (size > 0 ? size : splat(1))) * between}) {
    const auto lowest = [&](const V4(&x)[3]) {
      const F4 a = dot(n, x[0]), b = dot(n, x[1]), c = dot(n, x[2]);
      const F4 ab = a < b ? a : b;
      return ab < c ? ab : c;
    };
    const auto highest = [&](const V4(&x)[3]) {
      const F4 a = dot(n, x[0]), b = dot(n, x[1]), c = dot(n, x[2]);
      const F4 ab = a > b ? a : b;
      return ab > c ? ab : c;
    };
    apart |= (lowest(q.now) - highest(now) >= wanted) & (lowest(q.end) - highest(end) - bend >= wanted);
    apart |= (lowest(now) - highest(q.now) >= wanted) & (lowest(end) - highest(q.end) - bend >= wanted);
  }
  return bits(apart);
}

bool may_meet(const MaterialNeighbours* self, const BaseSimplex& a, const BaseSimplex& b) {
  return !self ||
         meet(*self, {a.vertex.data(), std::size_t(a.dim) + 1}, {b.vertex.data(), std::size_t(b.dim) + 1});
}

// The descent of the base trees: balls whose centres move (CA-8), then boxes enlarged by what their points
// can move.
class CertificateDescent {
 public:
  CertificateDescent(const SimplexPairCheck& check, const BaseFrames& frames, const NodeVelocity& a,
                     const NodeVelocity& b, const BaseTree& tree_a, const BaseTree& tree_b,
                     PartialCheck& part)
      : check_(check),
        frames_(frames),
        a_(a),
        b_(b),
        tree_a_(tree_a),
        tree_b_(tree_b),
        part_(part),
        self_(self_of(*check.a().shape, check.a().body, check.b().body)) {
    dt_ = float(check.dt());
    // what vertices travel seen from their bodies
    const double stretch = check.dt() * (largest_speed(check.a()) + largest_speed(check.b()));
    // fast bodies: what they travel is rounded as well
    const double travel =
        check.dt() * (double(a.v.norm()) + double(b.v.norm()) + double(a.spin + b.spin) * frames.scale);
    wanted_ = float(check.wanted() + stretch + 4e-6 * (frames.scale + travel + stretch + check.wanted()));
  }

  int near(const ConeNode& four, const ConeSlot& one, bool one_is_a) {
    if (part_.failed) return 0;
    const NodeVelocity &of_one = one_is_a ? a_ : b_, &of_four = one_is_a ? b_ : a_;
    const V4 x = load4(four.c), y = spread(one.node->c, one.lane), d = x - y;
    const F4 r_four = load4(four.r), r_one = splat(one.node->r[one.lane]);
    const F4 square = dot(d, d), reach = r_four + r_one + wanted_;
    const V4 drift = of_four.at(x) - of_one.at(y);
    const F4 bend = (of_four.bend(x) + of_one.bend(y)) * (0.5F * dt_ * dt_);
    const F4 distance = sqrt4(square), closing = dt_ * dot(d, drift);
    const F4 left = distance + (closing < 0 ? closing / distance : splat(0)) - bend;
    const I4 still = (square <= reach * reach) | (left * (1 - 1e-6F) <= reach);
    if (!bits(still)) return 0;
    const F4 spin = r_four * of_four.spin + r_one * of_one.spin;
    const F4 more =
        (r_four * of_four.spin * of_four.spin + r_one * of_one.spin * of_one.spin) * (0.5F * dt_ * dt_);
    const F4 moved = dt_ * (sqrt4(dot(drift, drift)) + spin) + bend + more;
    return bits(boxes_near(four, one, d, wanted_ + 1.0001F * moved, still));
  }

  void open(const ConeSlot& a) {
    for (int i = 0; i < a.count(); ++i) p_[i] = check_.start_a(tree_a_.simplex(a.first() + i));
    lanes_ = simplex_lanes(tree_a_, frames_.R, frames_.t, a_, dt_, a.first(), a.count());
  }

  void buckets(const ConeSlot& a, const ConeSlot& b) {
    if (part_.failed) return;
    const SimplexLanes lanes =
        simplex_lanes(tree_b_, Mat3::Identity(), -tree_b_.shape->centre, b_, dt_, b.first(), b.count());
    int left[kBucket] = {}, any = 0;
    for (int i = 0; i < a.count(); ++i) any |= left[i] = ~parted(lanes_, i, lanes, wanted_);
    for (int j = 0; j < b.count(); ++j) {
      if (!(any >> j & 1)) continue;
      const BaseSimplex simplex = tree_b_.simplex(b.first() + j);
      const MovingSimplex q = check_.start_b(simplex);
      for (int i = 0; i < a.count() && !part_.failed; ++i)
        if (left[i] >> j & 1 && !check_.far(p_[i], q) &&
            may_meet(self_, tree_a_.simplex(a.first() + i), simplex))
          check_.check(tree_a_.simplex(a.first() + i), simplex, p_[i], q, part_);
    }
  }

 private:
  const SimplexPairCheck& check_;
  const BaseFrames& frames_;
  const NodeVelocity &a_, &b_;
  const BaseTree &tree_a_, &tree_b_;
  PartialCheck& part_;
  const MaterialNeighbours* self_;
  float dt_ = 0, wanted_ = 0;
  MovingSimplex p_[kBucket];  // of A's open bucket
  SimplexLanes lanes_{};
};

// The same descent for the smallest distance at the start.
class DistanceDescent {
 public:
  DistanceDescent(const MovingShape& a, const MovingShape& b, const Instant& now_a, const Instant& now_b,
                  double scale, const BaseTree& tree_a, const BaseTree& tree_b, BaseDistance& part)
      : a_(a),
        b_(b),
        now_a_(now_a),
        now_b_(now_b),
        rounding_(4e-6 * scale),
        fine_rounding_(1e-14 * (scale + now_a.t.norm() + now_b.t.norm())),
        tree_a_(tree_a),
        tree_b_(tree_b),
        part_(part),
        self_(self_of(*a.shape, a.body, b.body)) {}
  int near(const ConeNode& four, const ConeSlot& one, bool) {
    const V4 d = load4(four.c) - spread(one.node->c, one.lane);
    const F4 limit = splat(float(part_.distance + rounding_));
    const F4 reach = load4(four.r) + one.node->r[one.lane] + limit;
    const I4 still = dot(d, d) <= reach * reach;
    return bits(still) ? bits(boxes_near(four, one, d, limit, still)) : 0;
  }
  void open(const ConeSlot& a) {
    for (int i = 0; i < a.count(); ++i) p_[i] = moving(a_, tree_a_.simplex(a.first() + i), now_a_, 0);
  }
  void buckets(const ConeSlot& a, const ConeSlot& b) {
    for (int j = 0; j < b.count(); ++j) {
      const MovingSimplex q = moving(b_, tree_b_.simplex(b.first() + j), now_b_, 0);
      for (int i = 0; i < a.count(); ++i) {
        if (are_apart(p_[i].points(), q.points(), part_.distance + fine_rounding_)) continue;
        if (!may_meet(self_, tree_a_.simplex(a.first() + i), tree_b_.simplex(b.first() + j))) continue;
        ++part_.simplex_pairs;
        const ClosestPoints closest = closest_points(p_[i].points(), q.points());
        if (closest.distance < part_.distance) part_.distance = closest.distance, part_.place = closest.x_a;
      }
    }
  }

 private:
  const MovingShape &a_, &b_;
  const Instant &now_a_, &now_b_;
  double rounding_, fine_rounding_;  // of the trees, in single precision, and of the simplices
  const BaseTree &tree_a_, &tree_b_;
  BaseDistance& part_;
  const MaterialNeighbours* self_;
  MovingSimplex p_[kBucket];  // of A's open bucket
};

int nearest_child(const ConeNode& four, const V4& to) {
  const V4 d = load4(four.c) - to;
  const F4 square = dot(d, d);
  int best = 0;  // always there
  for (int k = 1; k < 4; ++k)
    if (children_of(four) >> k & 1 && square[k] < square[best]) best = k;
  return best;
}

// The distance of two simplices that are near each other, found by opening the larger of two nodes and going
// on with the nearest child: not the smallest one, but a bound that spares the descent most of its way.
double some_distance(const MovingShape& a, const MovingShape& b, const Instant& now_a, const Instant& now_b,
                     const NodeMotion& motion, const BaseTree& tree_a, const BaseTree& tree_b) {
  const auto &nodes_a = tree_a.tree->nodes, &nodes_b = tree_b.tree->nodes;
  if (nodes_a.empty() || nodes_b.empty()) return kInf;
  ConeNode of_a = motion.moved(nodes_a[0]);
  const ConeNode* of_b = &nodes_b[0];
  int i = nearest_child(of_a, V4{}), j = nearest_child(*of_b, spread(of_a.c, i));
  while (of_a.count[i] == 0 || of_b->count[j] == 0) {
    const bool larger = of_a.r[i] >= of_b->r[j];
    if (of_b->count[j] > 0 || (of_a.count[i] == 0 && larger)) {
      of_a = motion.moved(nodes_a[of_a.child[i]]);
      i = nearest_child(of_a, spread(of_b->c, j));
    } else {
      of_b = &nodes_b[of_b->child[j]];
      j = nearest_child(*of_b, spread(of_a.c, i));
    }
  }
  double distance = kInf;
  for (std::uint32_t k = 0; k < of_a.count[i]; ++k) {
    const MovingSimplex p = moving(a, tree_a.simplex(int(of_a.child[i] + k)), now_a, 0);
    for (std::uint32_t l = 0; l < of_b->count[j]; ++l) {
      const MovingSimplex q = moving(b, tree_b.simplex(int(of_b->child[j] + l)), now_b, 0);
      distance = std::min(distance, closest_points(p.points(), q.points()).distance);
    }
  }
  return distance;
}

using TreePairs = std::vector<std::pair<BaseTree, BaseTree>>;

TreePairs all_pairs(const LmdShape& a, const LmdShape& b) {
  TreePairs pairs;
  for (const BaseTree& of_a : base_trees(a))
    for (const BaseTree& of_b : base_trees(b)) pairs.emplace_back(of_a, of_b);
  return pairs;
}

// Those with a simplex beside which coverage is not proven.
TreePairs unproven_pairs(const LmdShape& a, const LmdShape& b) {
  TreePairs pairs;
  for (const BaseTree& of_b : base_trees(b)) pairs.emplace_back(unproven_tree(a), of_b);
  for (const BaseTree& of_a : base_trees(a)) pairs.emplace_back(of_a, unproven_tree(b));
  return pairs;
}

constexpr std::size_t kFewNodes = 64;  // a tree with fewer is not worth so many parts

// Calls descend(tree_a, tree_b, run, part) for all pairs of trees and parts of their descent, each of which
// run(descent) runs. The parts depend on the trees alone.
template <class Result, class Descend>
std::vector<Result> over_trees(const TreePairs& pairs, int threads, const Result& start,
                               const Descend& descend) {
  struct Part {
    std::size_t pair;
    int cut;  // -1: all
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [a, b] = pairs[i];
    const std::size_t fewer = std::min(a.tree->nodes.size(), b.tree->nodes.size());
    if (fewer == 0) continue;
    if (fewer < kFewNodes)
      parts.push_back({i, -1});
    else
      for (int cut = 0; cut < kDescentParts; ++cut) parts.push_back({i, cut});
  }
  std::vector<Result> results(parts.size(), start);
  parallel_for(int(parts.size()), threads, [&](int i) {
    const auto& [pair, cut] = parts[std::size_t(i)];
    const auto run = [cut = cut](auto& descent) { cut < 0 ? descent.run_all() : descent.run(cut); };
    descend(pairs[pair].first, pairs[pair].second, run, results[std::size_t(i)]);
  });
  return results;
}

constexpr std::size_t kFewVertices = 64;  // of a shape that one plane may well part from another

// How far a shape reaches along n, at the start and after dt on straight lines, and how far its points bend
// away from these.
struct Reach {
  double now = -kInf, end = -kInf, bend = 0;
};
Reach reach_along(const MovingShape& m, const Vec3& n, double dt) {
  const LmdShape& shape = *m.shape;
  const Instant at = at_time(m, 0);
  const Vec3 along = at.R.transpose() * n, turn = at.R.transpose() * n.cross(at.w), then = along + dt * turn;
  Reach out;
  for (std::size_t i = 0; i < shape.complex.vertices.size(); ++i) {
    const Vec3& x = shape.complex.vertices[i];
    out.now = std::max(out.now, along.dot(x));
    out.end = std::max(out.end, then.dot(x) + (m.velocity.empty() ? 0 : dt * along.dot(m.velocity[i])));
  }
  const Vec3 arm = at.t - at.centre;
  out.now += n.dot(at.t);
  out.end += n.dot(at.t) + dt * n.dot(at.v + at.w.cross(arm));
  out.bend = at.w.squaredNorm() * ((at.R * shape.centre + arm).norm() + shape.bounding_radius);
  if (!m.velocity.empty()) out.bend += at.w.norm() * (2 + at.w.norm() * dt) * largest_speed(m);
  return out;
}

// (CA-7) for all vertices of both shapes at once (CA-15).
double separation_along(const MovingShape& a, const MovingShape& b, const Vec3& n, double dt) {
  if (a.shape->complex.vertices.size() > kFewVertices || b.shape->complex.vertices.size() > kFewVertices)
    return -kInf;
  const Reach of_a = reach_along(a, n, dt), of_b = reach_along(b, -n, dt);
  return std::min(-of_b.now - of_a.now, -of_b.end - of_a.end - (of_a.bend + of_b.bend) * dt * dt / 2);
}

PartialCheck check_pairs(const MovingShape& a, const MovingShape& b, double dt, const DistanceGoal& goal,
                         int threads, const TreePairs& pairs) {
  const SimplexPairCheck check(a, b, dt, goal);
  const BaseFrames frames = base_frames(a, b, check.now_a(), check.now_b());
  const NodeVelocity of_a(check.now_a(), check.now_b(), b.shape->centre);
  const NodeVelocity of_b(check.now_b(), check.now_b(), b.shape->centre);
  const auto descend = [&](const BaseTree& tree_a, const BaseTree& tree_b, const auto& run,
                           PartialCheck& part) {
    CertificateDescent tests(check, frames, of_a, of_b, tree_a, tree_b, part);
    DualDescent<CertificateDescent> descent(*tree_a.tree, *tree_b.tree, frames.motion, tests);
    run(descent);
  };
  PartialCheck all{.min_distance = goal.wanted};
  for (const PartialCheck& part : over_trees<PartialCheck>(pairs, threads, {}, descend)) add(part, all);
  return all;
}

// (CA-21)
PartialCheck check_minima(const MovingShape& a, const MovingShape& b, double dt, const DistanceGoal& goal,
                          int threads) {
  PartialCheck all = check_step_minima(a, b, dt, goal, threads);
  if (a.shape->unproven.empty() && b.shape->unproven.empty()) return all;
  const double slack = minima_slack(a, b);
  const DistanceGoal farther{goal.required + slack, goal.wanted + slack, goal.max_halvings};
  PartialCheck beside = check_pairs(a, b, dt, farther, threads, unproven_pairs(*a.shape, *b.shape));
  beside.min_distance -= slack;
  add(beside, all);
  return all;
}

Certificate certificate_of(const PartialCheck& all) {
  return {!all.failed, all.min_distance, all.simplex_pairs, all.rounds};
}

// Comparisons with NaN are false, as if all were far apart: check before.
bool is_finite(const RigidMotion& motion) {
  return all_finite(motion.g) && all_finite(motion.v) && all_finite(motion.omega);
}

}  // namespace

void describe(SettingVisitor& visit, CertificateOptions& o) {
  visit.begin("CertificateOptions");
  visit.number({"required", "distance that is never undercut", "m", range_above(0)}, o.required);
  visit.number({"wanted", "distance above which pairs are not examined further", "m", range_above(0)},
               o.wanted);
  visit.count(
      {"max_halvings", "maximum number of halvings of the time interval of two simplices", "", range_from(0)},
      o.max_halvings);
  visit.count(threads_setting(), o.threads);
}

Certificate certify(const MovingShape& a, const MovingShape& b, double dt,
                    const CertificateOptions& options) {
  check_ranges(options);
  require_field(options.wanted >= options.required, "CertificateOptions::wanted", options.wanted,
                "be at least `required`");
  for (const MovingShape* m : {&a, &b})
    if (!is_finite(m->motion) || !std::isfinite(largest_speed(*m)))
      return {.certified = false, .min_distance = 0};
  const bool self =
      self_of(*a.shape, a.body, b.body) != nullptr;  // no plane parts it, and minima may be neighbours
  if (!options.axis.isZero(0) && !self) {
    const double apart = separation_along(a, b, options.axis.normalized(), dt);
    if (apart >= options.required)
      return {.certified = true, .min_distance = std::min(apart, options.wanted), .rounds = 1};
  }
  const DistanceGoal goal{options.required, options.wanted, options.max_halvings};
  if (options.starts_apart && !self && has_step_minima(a, b, dt, options.required)) {
    PartialCheck minima = check_minima(a, b, dt, goal, options.threads);
    minima.min_distance = std::min(minima.min_distance, options.wanted);
    if (!minima.failed) return certificate_of(minima);
    if (is_seen_nearer(minima, options.required)) {
      minima.min_distance = minima.seen;
      return certificate_of(minima);
    }
  }
  return certificate_of(check_pairs(a, b, dt, goal, options.threads, all_pairs(*a.shape, *b.shape)));
}

BaseDistance find_base_distance(const MovingShape& a, const MovingShape& b, double cutoff, int threads) {
  if (!is_finite(a.motion) || !is_finite(b.motion)) return {std::numeric_limits<double>::quiet_NaN()};
  const Instant now_a = at_time(a, 0), now_b = at_time(b, 0);
  const BaseFrames frames = base_frames(a, b, now_a, now_b);
  const auto descend = [&](const BaseTree& tree_a, const BaseTree& tree_b, const auto& run,
                           BaseDistance& part) {
    DistanceDescent tests(a, b, now_a, now_b, frames.scale, tree_a, tree_b, part);
    DualDescent<DistanceDescent> descent(*tree_a.tree, *tree_b.tree, frames.motion, tests);
    run(descent);
  };
  const TreePairs pairs = all_pairs(*a.shape, *b.shape);
  const bool self = self_of(*a.shape, a.body, b.body) != nullptr;
  for (const auto& [tree_a, tree_b] :
       self ? TreePairs() : pairs)  // a little more, so that the descent finds the pair again
    cutoff = std::min(cutoff,
                      some_distance(a, b, now_a, now_b, frames.motion, tree_a, tree_b) + 1e-9 * frames.scale);
  BaseDistance out{cutoff};
  for (const BaseDistance& part : over_trees<BaseDistance>(pairs, threads, {cutoff}, descend)) {
    if (part.distance < out.distance) out.distance = part.distance, out.place = part.place;
    out.simplex_pairs += part.simplex_pairs;
  }
  return out;
}

double base_distance(const MovingShape& a, const MovingShape& b, double cutoff, int threads) {
  return find_base_distance(a, b, cutoff, threads).distance;
}

}  // namespace aussois
