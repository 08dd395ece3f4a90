// SPDX-License-Identifier: Apache-2.0
#include "lmd/step_minima.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/parallel.hpp"
#include "lmd/coverage.hpp"
#include "lmd/leaf_trees.hpp"
#include "lmd/pair_search.hpp"
#include "lmd/path_filter.hpp"
#include "lmd/recent_lanes.hpp"

namespace aussois {
namespace {

constexpr double kLargestTurn = 0.2;  // of A past B in a step that cones still exclude something for [rad]

SE3 placed(const MovingShape& m, double s) {
  return pose_at(m.motion, s) * m.g_bs;
}

// How far a point of A leaves, seen from B, the chord of its path: an eighth of dt^2 times (CA-14).
double off_chord(const MovingShape& a, const MovingShape& b, double dt) {
  const Vec3 centre = placed(a, 0) * a.shape->centre;
  return dt * dt / 8 *
         acceleration_bound(approach_of(a.motion, b.motion, dt), centre, a.shape->bounding_radius);
}

// The pair at the start, and where its motion leads; B's shape frame, moved to B's centre, rests.
struct StepFrames {
  RelativePair pair{};
  NodeMotion motion;
  Eigen::Matrix3f D = Eigen::Matrix3f::Zero();    // a point x of A moves by D x + tau
  Eigen::Vector3f tau = Eigen::Vector3f::Zero();  // [m]
  double way = 0;                                 // how far points of A move at most [m]
  double turn = 0;                                // [rad]
  double bend = 0;   // how far paths leave their chords at most, either seen from the other [m]
  double scale = 0;  // of positions [m]
  LeafFrame a_now{}, a_end{}, b{};     // in B's frame
  LeafFrame of_a{}, b_now{}, b_end{};  // in A's
};

LeafFrame leaf_frame(const LmdShape& shape, const Mat3& R, const Vec3& t) {
  return {&shape, R.cast<float>(), shape.centre, t.cast<float>()};
}

StepFrames step_frames(const MovingShape& a, const MovingShape& b, double dt, double reach) {
  const LmdShape &of_a = *a.shape, &of_b = *b.shape;
  const RelativePair pair = relative_pair({&of_a, placed(a, 0), {}}, {&of_b, placed(b, 0), {}},
                                          {.threshold = reach - of_a.radius - of_b.radius});
  const SE3 end = inverse(placed(b, dt)) * placed(a, dt);
  const Mat3 R0 = pair.R, R1 = end.R.toRotationMatrix(), turn = R1 * R0.transpose();
  const Vec3 t0 = R0 * of_a.centre + pair.t - of_b.centre, t1 = R1 * of_a.centre + end.p - of_b.centre;
  const Vec3 tau = t1 - turn * t0;
  StepFrames out{.pair = pair, .motion = NodeMotion(R0, t0)};
  out.D = (turn - Mat3::Identity()).cast<float>(), out.tau = tau.cast<float>();
  out.turn = relative_rotation_bound(a.motion, b.motion, dt);
  out.way = (t1 - t0).norm() + out.turn * of_a.bounding_radius;
  out.bend = std::max(off_chord(a, b, dt), off_chord(b, a, dt)) * (1 + 1e-6);
  out.scale = of_a.bounding_radius + of_b.bounding_radius + std::max(t0.norm(), t1.norm()) + out.way + reach;
  out.a_now = leaf_frame(of_a, R0, t0), out.a_end = leaf_frame(of_a, R1, t1);
  out.b_now = leaf_frame(of_b, R0.transpose(), -(R0.transpose() * t0));
  out.b_end = leaf_frame(of_b, R1.transpose(), -(R1.transpose() * t1));
  out.of_a = leaf_frame(of_a, Mat3::Identity(), Vec3::Zero());
  out.b = leaf_frame(of_b, Mat3::Identity(), Vec3::Zero());
  return out;
}

// Two trees to be descended.
struct StepTrees {
  TreeOfLeaves a{}, b{};
  float reach = 0;  // rounding included [m]
  CapLimits caps{};
  PathLimits limits{};
};

StepTrees step_trees(const StepFrames& f, double wanted, const TreeOfLeaves& a, const TreeOfLeaves& b) {
  const MinimumCriteria& c = f.pair.criteria;
  const double slack = angle_slack(f.pair), rounding = 4e-6 * f.scale;
  StepTrees out{.a = a, .b = b};
  out.reach = float(wanted + f.bend + rounding);
  out.caps = cap_limits(f.pair, a.first, b.first, f.turn);
  out.limits = {.reach = out.reach,
                .foot = float(c.tolerance + f.bend + rounding),
                .sin_vertex = float(c.sin_alpha + slack + f.turn) + 1e-5F,
                .sin_edges = float(c.sin_alpha_ee + slack) + 1e-4F,
                .turn = float(f.turn * (1 + 1e-6)),
                .way = float(f.way * (1 + 1e-6)),
                .bend = float(f.bend * (1 + 1e-6))};
  return out;
}

BaseSimplex simplex_of(const LmdShape& shape, LeafId id) {
  if (id.dim == 0) return {0, {shape.vertices[id.index].vertex}};
  if (id.dim == 1) return {1, {shape.edges[id.index].first, shape.edges[id.index].last}};
  const auto& t = shape.complex.triangles[shape.faces[id.index]];
  return {2, {t[0], t[1], t[2]}};
}

// Nodes by the ways of their centres, cones and boxes; then leaves; then what is left in double precision.
class StepDescent {
 public:
  StepDescent(const StepFrames& frames, const StepTrees& trees, const SimplexPairCheck& check,
              PartialCheck& part)
      : f_(frames), trees_(trees), check_(check), part_(part) {}

  AUSSOIS_INLINE int near(const ConeNode& four, const ConeSlot& one, bool one_is_a) {
    const V4 x = load4(four.c), y = spread(one.node->c, one.lane), d = x - y;
    const V4 moved = way_of(one_is_a ? y : x);
    const V4 shift = one_is_a ? V4{-moved.x, -moved.y, -moved.z} : moved;
    const F4 r_four = load4(four.r), r_one = splat(one.node->r[one.lane]), both = r_four + r_one;
    const F4 limit = both + trees_.reach;
    I4 still = nearest_square(d, d + shift) <= limit * limit;
    if (!bits(still)) return 0;
    still &= caps_oppose(four, one, trees_.caps);
    if (!bits(still)) return 0;
    const F4 turned = trees_.limits.turn * (one_is_a ? r_one : r_four);
    still = boxes_near<true>(four, one, d, shift, trees_.reach + turned, still);
    if (!bits(still)) return 0;
    const V4 middle = d + splat(0.5F) * shift;
    const F4 around = both + 0.5F * sqrt4(dot(shift, shift)) + float(f_.bend);
    return bits(still &
                directions_meet(four, one, one_is_a, middle, around, dot(middle, middle), trees_.caps));
  }

  AUSSOIS_INLINE void open(const ConeSlot& a) {
    const int first = trees_.a.first.index + a.first(), count = a.count(), side = trees_.a.first.side;
    if (trees_.a.first.dim == 0)
      corners_ = {vertex_lanes(f_.a_now, first, count).p, vertex_lanes(f_.a_end, first, count).p};
    if (trees_.a.first.dim == 1 && trees_.b.first.dim == 1) {
      edges_ = edge_lanes(f_.a_now, first, count);
      edges_end_ = edge_lanes(f_.a_end, first, count);
    }
    if (trees_.a.first.dim == 1 && trees_.b.first.dim == 0) edges_ = edge_lanes(f_.of_a, first, count);
    if (trees_.a.first.dim == 2) faces_ = face_lanes(f_.of_a, first, count, side);
  }

  AUSSOIS_INLINE void buckets(const ConeSlot& a, const ConeSlot& b) {
    const int first = trees_.b.first.index + b.first(), side = trees_.b.first.side;
    switch (3 * trees_.a.first.dim + trees_.b.first.dim) {
      case 0:
        return corners_of_a(a, b, vertex_lanes(f_.b, first, b.count()));
      case 1:
        return corners_of_a(a, b, edges_of_b_.get(first, [&] { return edge_lanes(f_.b, first, b.count()); }));
      case 2:
        return corners_of_a(a, b,
                            faces_of_b_.get(first, [&] { return face_lanes(f_.b, first, b.count(), side); }));
      case 3:
        return corners_of_b(a, b, edges_);
      case 4: {
        const EdgeLanes& lanes = edges_of_b_.get(first, [&] { return edge_lanes(f_.b, first, b.count()); });
        for (int i = 0; i < a.count(); ++i)
          check(a, i, b, may_meet(edges_, edges_end_, i, lanes, trees_.limits));
        return;
      }
      default:
        return corners_of_b(a, b, faces_);
    }
  }

 private:
  AUSSOIS_INLINE V4 way_of(const V4& x) const { return times(f_.D, x) + spread(f_.tau); }

  template <class Lanes>
  AUSSOIS_INLINE void corners_of_a(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes) {
    for (int i = 0; i < a.count(); ++i) {
      const VertexLeaf& v = f_.pair.a->vertices[trees_.a.first.index + a.first() + i];
      check(a, i, b, may_meet(f_.a_now, v, spread(corners_, i), lanes, trees_.limits));
    }
  }

  template <class Lanes>
  AUSSOIS_INLINE void corners_of_b(const ConeSlot& a, const ConeSlot& b, const Lanes& lanes) {
    const int first = trees_.b.first.index + b.first();
    const PointPath& corners = corners_of_b_.get(first, [&] {
      return PointPath{vertex_lanes(f_.b_now, first, b.count()).p,
                       vertex_lanes(f_.b_end, first, b.count()).p};
    });
    for (int j = 0; j < b.count(); ++j) {
      const int left =
          may_meet(f_.b_now, f_.pair.b->vertices[first + j], spread(corners, j), lanes, trees_.limits);
      for (int i = 0; i < a.count(); ++i)
        if (left >> i & 1) check(a, i, b, 1 << j);
    }
  }

  // Leaf i of A's bucket against those of B's whose bits are set.
  void check(const ConeSlot& a, int i, const ConeSlot& b, int lanes) {
    if (lanes == 0) return;
    LeafId id = trees_.a.first;
    id.index += a.first() + i;
    const BaseSimplex of_a = simplex_of(*f_.pair.a, id);
    const MovingSimplex p = check_.start_a(of_a);
    for (int j = 0; j < b.count(); ++j) {
      if (!(lanes >> j & 1)) continue;
      LeafId other = trees_.b.first;
      other.index += b.first() + j;
      const BaseSimplex of_b = simplex_of(*f_.pair.b, other);
      const MovingSimplex q = check_.start_b(of_b);
      if (check_.far(p, q)) continue;
      PartialCheck pair;
      check_.check(of_a, of_b, p, q, pair);
      add(pair, part_);
    }
  }

  const StepFrames& f_;
  const StepTrees& trees_;
  const SimplexPairCheck& check_;
  PartialCheck& part_;
  PointPath corners_{};  // of A's open bucket
  EdgeLanes edges_{}, edges_end_{};
  FaceLanes faces_{};
  RecentLanes<EdgeLanes> edges_of_b_{};
  RecentLanes<FaceLanes> faces_of_b_{};
  RecentLanes<PointPath> corners_of_b_{};
};

}  // namespace

bool has_step_minima(const MovingShape& a, const MovingShape& b, double dt, double required) {
  const auto is_mostly_proven = [](const LmdShape& s) {
    return 4 * s.unproven.size() <= std::size_t(base_count(s));
  };
  return is_mostly_proven(*a.shape) && is_mostly_proven(*b.shape) && a.velocity.empty() &&
         b.velocity.empty() && relative_rotation_bound(a.motion, b.motion, dt) <= kLargestTurn &&
         required >= (a.shape->radius + b.shape->radius) / 2;
}

double minima_slack(const MovingShape& a, const MovingShape& b) {
  const PosedShape at_a{a.shape, placed(a, 0), {}}, at_b{b.shape, placed(b, 0), {}};
  return 1.5 * coverage_tolerance(at_a, at_b) + 2 * relative_pair(at_a, at_b, {}).criteria.tolerance;
}

PartialCheck check_step_minima(const MovingShape& a, const MovingShape& b, double dt,
                               const DistanceGoal& goal, int threads) {
  const double slack = minima_slack(a, b), wanted = goal.wanted + slack;
  const SimplexPairCheck check(a, b, dt, {goal.required + slack, wanted, goal.max_halvings});
  const StepFrames frames = step_frames(a, b, dt, wanted);
  std::vector<StepTrees> trees;
  for (const TreeOfLeaves& of_a : trees_of(*a.shape))
    for (const TreeOfLeaves& of_b : trees_of(*b.shape))
      if (can_touch(of_a.first.dim, of_b.first.dim)) trees.push_back(step_trees(frames, wanted, of_a, of_b));
  PartialCheck all{.min_distance = wanted};
  const auto descend = [&](const StepTrees& pair, PartialCheck& part, auto run) {
    StepDescent tests(frames, pair, check, part);
    DualDescent<StepDescent> descent(*pair.a.tree, *pair.b.tree, frames.motion, tests);
    run(descent);
  };
  if (threads == 1) {
    for (const StepTrees& pair : trees) descend(pair, all, [](auto& descent) { descent.run_all(); });
  } else {
    std::vector<PartialCheck> parts(trees.size() * kDescentParts);
    parallel_for(int(parts.size()), threads, [&](int i) {
      descend(trees[std::size_t(i) / kDescentParts], parts[i],
              [&](auto& descent) { descent.run(i % kDescentParts); });
    });
    for (const PartialCheck& part : parts) add(part, all);
  }
  all.min_distance -= slack;
  return all;
}

}  // namespace aussois
