// SPDX-License-Identifier: Apache-2.0
#include "lmd/certificate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "lmd/dual_traversal.hpp"
#include "lmd/simplex_distance.hpp"

namespace aussois {
namespace {

// A body at some time of the step, seen from the world: what the separation bound needs of it.
struct Instant {
  Mat3 R = Mat3::Identity();  // shape frame to world
  Vec3 t = Vec3::Zero();
  Vec3 centre = Vec3::Zero();               // reference point, world
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  // world
};

Instant at_time(const MovingShape& m, double s) {
  const SE3 g = pose_at(m.motion, s), g_ws = g * m.g_bs;
  return {g_ws.R.toRotationMatrix(), g_ws.p, g.p, m.motion.v, g.R * m.motion.omega};
}

struct MovingSimplex {
  Vec3 x[3], v[3];  // vertices and their velocities, world
  int count = 0;
  double bend = 0;  // bound of |d^2 x / ds^2|
  std::span<const Vec3> points() const { return {x, std::size_t(count)}; }
};

MovingSimplex moving(const LmdShape& shape, int item, const Instant& now) {
  const BaseSimplex& s = shape.simplices[std::size_t(item)];
  MovingSimplex out;
  out.count = s.dim + 1;
  double reach = 0;
  for (int i = 0; i <= s.dim; ++i) {
    out.x[i] = now.R * shape.complex.vertices[std::size_t(s.vertex[std::size_t(i)])] + now.t;
    const Vec3 arm = out.x[i] - now.centre;
    out.v[i] = now.v + now.w.cross(arm);
    reach = std::max(reach, arm.squaredNorm());
  }
  out.bend = now.w.squaredNorm() * std::sqrt(reach);
  return out;
}

// All simplices and nodes at the start of the step, once each and not once per pair.
struct Snapshot {
  Snapshot(const MovingShape& m) : now(at_time(m, 0)), nodes(m.shape->base.nodes.data()) {
    for (int i = 0; i < int(m.shape->simplices.size()); ++i) simplices.push_back(moving(*m.shape, i, now));
    for (const BvhNode& node : m.shape->base.nodes) {
      const Vec3 x = now.R * node.centre + now.t, arm = x - now.centre;
      centre.push_back(x);
      velocity.push_back(now.v + now.w.cross(arm));
      bend.push_back(now.w.squaredNorm() * arm.norm());
    }
  }
  std::size_t index(const BvhNode& node) const { return std::size_t(&node - nodes); }
  Instant now;
  const BvhNode* nodes;
  std::vector<MovingSimplex> simplices{};
  std::vector<Vec3> centre{}, velocity{};  // of the nodes' balls
  std::vector<double> bend{};
};

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
// of an edge in their plane. True if `try_direction` says that nothing better is wanted.
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

struct Part {
  bool failed = false;
  double min_distance = kInf;
  long simplex_pairs = 0, rounds = 0;
};

class PairCheck {
 public:
  PairCheck(const MovingShape& a, const MovingShape& b, double dt, const CertificateOptions& options)
      : a_(a), b_(b), dt_(dt), options_(options), a0_(a), b0_(b) {}

  // Balls around body-fixed points: only their centres move (CA-8).
  bool far(const BvhNode& n, const BvhNode& m, Part& part) const {
    if (part.failed) return true;
    const std::size_t i = a0_.index(n), j = b0_.index(m);
    const Vec3 c = b0_.centre[j] - a0_.centre[i];
    const double square = c.squaredNorm(), reach = n.radius + m.radius + options_.wanted;
    if (square <= reach * reach) return false;
    const double distance = std::sqrt(square);
    const double closing = std::min(0.0, c.dot(b0_.velocity[j] - a0_.velocity[i]) / distance);
    return distance + dt_ * closing - (a0_.bend[i] + b0_.bend[j]) * dt_ * dt_ / 2 > reach;
  }

  void check(int i, int j, Part& part) const {
    if (part.failed) return;
    ++part.simplex_pairs;
    check_interval(i, j, 0, dt_, options_.max_halvings, a0_.simplices[std::size_t(i)],
                   b0_.simplices[std::size_t(j)], part);
  }

 private:
  void check_interval(int i, int j, double s0, double s1, int halvings, const MovingSimplex& p,
                      const MovingSimplex& q, Part& part) const {
    ++part.rounds;
    const double dt = s1 - s0;
    double bound = -kInf;
    const auto try_direction = [&](const Vec3& n) {
      bound = std::max(bound, separation(p, q, n, dt));
      return bound >= options_.wanted;
    };
    for (const MovingSimplex* s : {&p, &q})  // the planes of the triangles are cheap and mostly enough
      if (s->count == 3) {
        const Vec3 n = (s->x[1] - s->x[0]).cross(s->x[2] - s->x[0]).normalized();
        if (try_direction(n) || try_direction(-n)) return;
      }
    const ClosestPoints closest = closest_points(p.points(), q.points());
    if (closest.distance < options_.required) {
      part.failed = true;
      part.min_distance = std::min(part.min_distance, closest.distance);
      return;
    }
    if (try_direction((closest.x_b - closest.x_a) / closest.distance)) return;
    if (bound < options_.required && try_edge_directions(p, q, try_direction)) return;
    if (bound >= options_.required) {
      part.min_distance = std::min(part.min_distance, bound);
      return;
    }
    if (halvings == 0) {
      part.failed = true;
      part.min_distance = std::min(part.min_distance, bound);
      return;
    }
    const double middle = (s0 + s1) / 2;
    check_interval(i, j, s0, middle, halvings - 1, p, q, part);
    if (!part.failed)
      check_interval(i, j, middle, s1, halvings - 1, moving(*a_.shape, i, at_time(a_, middle)),
                     moving(*b_.shape, j, at_time(b_, middle)), part);
  }

  const MovingShape &a_, &b_;
  double dt_;
  const CertificateOptions& options_;
  Snapshot a0_, b0_;
};

}  // namespace

Certificate certify(const MovingShape& a, const MovingShape& b, double dt,
                    const CertificateOptions& options) {
  require_field(options.required > 0, "CertificateOptions::required", options.required, "be positive [m]");
  require_field(options.wanted >= options.required, "CertificateOptions::wanted", options.wanted,
                "be at least `required`");
  const PairCheck check(a, b, dt, options);
  const auto prune = [&](const BvhNode& n, const BvhNode& m, Part& part) { return check.far(n, m, part); };
  const auto leaf = [&](int i, int j, Part& part) { check.check(i, j, part); };
  Certificate out{.certified = true, .min_distance = options.wanted};
  for (const Part& part : traverse_pairs<Part>(a.shape->base, b.shape->base, options.threads, prune, leaf)) {
    out.certified = out.certified && !part.failed;
    out.min_distance = std::min(out.min_distance, part.min_distance);
    out.simplex_pairs += part.simplex_pairs;
    out.rounds += part.rounds;
  }
  return out;
}

double base_distance(const MovingShape& a, const MovingShape& b, double cutoff, int threads) {
  const Instant now_a = at_time(a, 0), now_b = at_time(b, 0);
  struct Nearest {
    double distance = kInf;
  };
  const auto prune = [&](const BvhNode& n, const BvhNode& m, Nearest& part) {
    const double centres = ((now_b.R * m.centre + now_b.t) - (now_a.R * n.centre + now_a.t)).norm();
    return centres - n.radius - m.radius >= std::min(cutoff, part.distance);
  };
  const auto leaf = [&](int i, int j, Nearest& part) {
    const MovingSimplex p = moving(*a.shape, i, now_a), q = moving(*b.shape, j, now_b);
    part.distance = std::min(part.distance, closest_points(p.points(), q.points()).distance);
  };
  double distance = cutoff;
  for (const Nearest& part : traverse_pairs<Nearest>(a.shape->base, b.shape->base, threads, prune, leaf))
    distance = std::min(distance, part.distance);
  return distance;
}

}  // namespace aussois
