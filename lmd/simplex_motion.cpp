// SPDX-License-Identifier: Apache-2.0
#include "lmd/simplex_motion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "lmd/simplex_distance.hpp"

namespace aussois {
namespace {

constexpr double kSurely = 1 - 1e-9;  // what is nearer than so much of a distance is so beyond rounding

// Lower bound of the separation along n (from a to b) during [0, dt]: linear in time at each vertex, so
// concave, so smallest at an end; what the linear path misses is at most half the bends times dt^2 (CA-7).
double separation(const MovingSimplex& a, const MovingSimplex& b, const Vec3& n, double dt) {
  double a_now = -kInf, a_end = -kInf, b_now = kInf, b_end = kInf;
  for (int i = 0; i < a.count; ++i) {
    const double x = n.dot(a.x[i]);
    a_now = std::max(a_now, x);
    a_end = std::max(a_end, x + dt * n.dot(a.v[i]));
  }
  for (int i = 0; i < b.count; ++i) {
    const double x = n.dot(b.x[i]);
    b_now = std::min(b_now, x);
    b_end = std::min(b_end, x + dt * n.dot(b.v[i]));
  }
  return std::min(b_now - a_now, b_end - a_end - (a.bend + b.bend) * dt * dt / 2);
}

// Edges that slide across each other are parted by their common perpendicular, coplanar triangles by a normal
// of an edge in their plane. True if `try_direction` needs no better one.
template <class TryDirection>
bool try_edge_directions(const MovingSimplex& p, const MovingSimplex& q, const TryDirection& try_direction) {
  const auto edge = [](const MovingSimplex& s, int i) { return Vec3(s.x[(i + 1) % s.count] - s.x[i]); };
  const auto both_ways = [&](const Vec3& n) {
    return n.norm() > 0 && (try_direction(n.normalized()) || try_direction(-n.normalized()));
  };
  for (int e = 0; e < p.count; ++e)
    for (int f = 0; f < q.count; ++f)
      if (both_ways(edge(p, e).cross(edge(q, f)))) return true;
  for (const MovingSimplex* s : {&p, &q})
    if (s->count == 3)
      for (int e = 0; e < 3; ++e)
        if (both_ways(edge(*s, 0).cross(edge(*s, 1)).cross(edge(*s, e)))) return true;
  return false;
}

}  // namespace

Instant at_time(const MovingShape& m, double s) {
  const SE3 g = pose_at(m.motion, s), g_ws = g * m.g_bs;
  return {g_ws.R.toRotationMatrix(), g_ws.p, g.p, m.motion.v, g.R * m.motion.omega, s};
}

double largest_speed(const MovingShape& m) {
  double square = 0;
  for (const Vec3& v : m.velocity) square = std::max(square, v.squaredNorm());
  return std::sqrt(square);
}

MovingSimplex moving(const MovingShape& m, const BaseSimplex& s, const Instant& now, double dt) {
  MovingSimplex out;
  out.count = s.dim + 1;
  double reach = 0, speed = 0;
  for (int i = 0; i <= s.dim; ++i) {
    const auto v = std::size_t(s.vertex[i]);
    out.x[i] = now.R * m.shape->complex.vertices[v] + now.t;
    if (!m.velocity.empty()) out.x[i] += now.since * (now.R * m.velocity[v]);
    const Vec3 arm = out.x[i] - now.centre;
    out.v[i] = now.v + now.w.cross(arm);
    if (!m.velocity.empty()) {
      out.v[i] += now.R * m.velocity[v];
      speed = std::max(speed, m.velocity[v].squaredNorm());
    }
    reach = std::max(reach, arm.squaredNorm());
    out.centre += out.x[i] / out.count;
    out.drift += out.v[i] / out.count;
  }
  for (int i = 0; i <= s.dim; ++i) out.radius = std::max(out.radius, (out.x[i] - out.centre).squaredNorm());
  out.radius = std::sqrt(out.radius) * (1 + 1e-12);
  out.bend = now.w.squaredNorm() * std::sqrt(reach);
  if (speed > 0) {
    const double u = std::sqrt(speed), spin = now.w.norm();
    out.bend += spin * (2 + spin * dt) * u;
    out.radius += 2 * dt * u;
  }
  return out;
}

void add(const PartialCheck& part, PartialCheck& all) {
  all.failed = all.failed || part.failed;
  all.min_distance = std::min(all.min_distance, part.min_distance);
  all.seen = std::min(all.seen, part.seen);
  all.simplex_pairs += part.simplex_pairs;
  all.rounds += part.rounds;
}

bool is_seen_nearer(const PartialCheck& part, double distance) {
  return part.seen < kSurely * distance;
}

SimplexPairCheck::SimplexPairCheck(const MovingShape& a, const MovingShape& b, double dt,
                                   const DistanceGoal& goal)
    : a_(a), b_(b), dt_(dt), goal_(goal), a0_(at_time(a, 0)), b0_(at_time(b, 0)) {}

bool SimplexPairCheck::far(const MovingSimplex& p, const MovingSimplex& q) const {
  const Vec3 c = q.centre - p.centre;
  const double square = c.squaredNorm(), reach = p.radius + q.radius + goal_.wanted;
  if (square <= reach * reach) return false;
  const double distance = std::sqrt(square);
  const double closing = std::min(0.0, c.dot(q.drift - p.drift) / distance);
  return distance + dt_ * closing - (p.bend + q.bend) * dt_ * dt_ / 2 > reach;
}

void SimplexPairCheck::check(const BaseSimplex& of_a, const BaseSimplex& of_b, const MovingSimplex& p,
                             const MovingSimplex& q, PartialCheck& part) const {
  ++part.simplex_pairs;
  check_interval({of_a, of_b}, 0, dt_, goal_.max_halvings, p, q, part);
}

void SimplexPairCheck::check_interval(const Pair& pair, double s0, double s1, int halvings,
                                      const MovingSimplex& p, const MovingSimplex& q,
                                      PartialCheck& part) const {
  ++part.rounds;
  const double dt = s1 - s0;
  double bound = -kInf;
  const auto try_direction = [&](const Vec3& n) {
    bound = std::max(bound, separation(p, q, n, dt));
    return bound >= goal_.wanted;
  };
  for (const MovingSimplex* s : {&p, &q})  // the planes of the triangles are cheap and mostly enough
    if (s->count == 3) {
      const Vec3 n = (s->x[1] - s->x[0]).cross(s->x[2] - s->x[0]).normalized();
      if (try_direction(n) || try_direction(-n)) return;
    }
  Vec3 n =
      q.centre - p.centre;  // then from one support point to the other, along where they are nearest so far
  for (int k = 0; k < 4 && n.squaredNorm() > 0; ++k) {
    n.normalize();
    if (try_direction(n)) return;
    n = *std::ranges::min_element(q.points(), {}, [&](const Vec3& x) { return n.dot(x); }) -
        *std::ranges::max_element(p.points(), {}, [&](const Vec3& x) { return n.dot(x); });
  }
  const ClosestPoints closest = closest_points(p.points(), q.points());
  if (closest.distance < goal_.required) {
    part.failed = true;
    part.min_distance = std::min(part.min_distance, closest.distance);
    part.seen = std::min(part.seen, closest.distance);
    return;
  }
  if (try_direction((closest.x_b - closest.x_a) / closest.distance)) return;
  if (bound < goal_.required && try_edge_directions(p, q, try_direction)) return;
  if (bound >= goal_.required) {
    part.min_distance = std::min(part.min_distance, bound);
    return;
  }
  if (halvings == 0) {
    part.failed = true;
    part.min_distance = std::min(part.min_distance, bound);
    return;
  }
  if (halvings == goal_.max_halvings && ends_too_near(pair, part)) return;
  const double middle = (s0 + s1) / 2;
  check_interval(pair, s0, middle, halvings - 1, p, q, part);
  if (!part.failed)
    check_interval(pair, middle, s1, halvings - 1, moving(a_, pair.a, at_time(a_, middle), s1 - middle),
                   moving(b_, pair.b, at_time(b_, middle), s1 - middle), part);
}

// Bodies that run into each other mostly end the step too near: then halving finds nothing but more rounds.
bool SimplexPairCheck::ends_too_near(const Pair& pair, PartialCheck& part) const {
  const double at_end = closest_points(moving(a_, pair.a, at_time(a_, dt_), 0).points(),
                                       moving(b_, pair.b, at_time(b_, dt_), 0).points())
                            .distance;
  if (at_end >= kSurely * goal_.required) return false;
  part.failed = true;
  part.min_distance = std::min(part.min_distance, at_end);
  part.seen = std::min(part.seen, at_end);
  return true;
}

}  // namespace aussois
