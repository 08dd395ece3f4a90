// SPDX-License-Identifier: Apache-2.0
// Why contacts come and go along a smooth motion: every event is brought to its instant by bisection and
// classified as (KIN-11) says, on repaired meshes with what (KIN-12) adds. Anything else is unexplained, and
// a bug.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lmd/contact_kinematics.hpp"
#include "lmd/coverage.hpp"
#include "lmd/normal_cone.hpp"
#include "lmd/simplex_distance.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {

/// Counts of events, and the worst that was seen.
struct ContinuityAudit {
  long motions = 0, poses = 0, contacts = 0;
  long at_threshold = 0, at_angle = 0, handovers = 0, dominated = 0, unexplained = 0;
  long uncovered = 0;                   // poses where (LMD-14) does not hold
  double nearest = kInf, farthest = 0;  // base distances of the poses [m]
  double handover_gap = 0;              // jump of the gap [m]
  double handover_share = 0;            // the same over the bound after (KIN-12) [-]
  double handover_turn = 0;             // of the normal [-]
  double handover_rate = 0;             // of gap_rate [m/s]
  double track = 0;  // | mean rate over a step - mean of gap_rate xi at its ends | of contacts that stay,
                     // over speed (step (1 + speed / distance))^2
};

/// A smooth motion of A: a turning, swaying path around the place where it began, with rates of order one.
struct SmoothMotion {
  SE3 g{};
  Vec3 sway = Vec3::Zero(), turn = Vec3::Zero(), phase = Vec3::Zero();
  SE3 at(double t) const {
    Vec3 x, phi;
    for (int i = 0; i < 3; ++i) {
      x[i] = sway[i] * std::sin((1 + 0.3 * i) * t + phase[i]);
      phi[i] = turn[i] * std::sin((1.1 - 0.2 * i) * t + 2 * phase[i]);
    }
    return {(exp_so3(phi) * g.R).normalized(), g.p + x};
  }
  /// Twist at t: v in the world, omega in the body, by central differences (2e-11).
  Vec6 twist(double t) const {
    const double h = 1e-5;
    const SE3 before = at(t - h), after = at(t + h);
    Vec6 out;
    out << (after.p - before.p) / (2 * h), log_so3(before.R.conjugate() * after.R) / (2 * h);
    return out;
  }
  /// Bounds at all times of the speed of the origin and of the angular velocity.
  double speed() const { return sway.cwiseProduct(Vec3(1, 1.3, 1.6)).norm(); }
  double spin() const { return turn.cwiseProduct(Vec3(1.1, 0.9, 0.7)).norm(); }
};

inline const ContactPoint* find_key(const ContactSet& set, const ContactKey& key) {
  for (const ContactPoint& c : set.points)
    if (key_of(c) == key) return &c;
  return nullptr;
}

/// Where a point ends that goes down towards p on the triangles of a complex: from the place nearest to `x`
/// on one of the triangles `at`, over triangles within `touch` of where it is. Knows no regions, no chains
/// and no cones. `x` where there is no triangle.
inline Vec3 descend(const SimplicialComplex& k, std::vector<int> at, Vec3 x, const Vec3& p, double touch) {
  const auto nearest = [&](int t, const Vec3& q) {
    const auto& v = k.triangles[t];
    const Vec3 corners[] = {k.vertices[v[0]], k.vertices[v[1]], k.vertices[v[2]]};
    return closest_points({corners, 3}, {&q, 1});
  };
  if (at.empty()) return x;
  x = nearest(*std::ranges::min_element(at, {}, [&](int t) { return nearest(t, x).distance; }), x).x_a;
  for (;;) {
    for (std::size_t i = 0; i < at.size(); ++i)  // all that touch x
      for (const int v : k.triangles[at[i]])
        for (const int t : k.vertex_triangles[v])
          if (std::ranges::find(at, t) == at.end() && nearest(t, x).distance <= touch) at.push_back(t);
    Vec3 lowest = x;
    int carrier = -1;
    for (const int t : at) {
      const ClosestPoints found = nearest(t, p);
      if (found.distance < (lowest - p).norm() - 1e-14) lowest = found.x_a, carrier = t;
    }
    if (carrier < 0) return x;
    x = lowest;
    at = {carrier};
  }
}

/// What the faces of shapes are.
enum class Faces {
  exact,      // planes to rounding
  idealised,  // of repaired meshes: off by the tolerance of regions and chains
};

class ContinuityAuditor {
 public:
  /// Motions end where the bases come nearer than `nearest` [m].
  ContinuityAuditor(const RandomPair& pair, const SmoothMotion& motion, const LmdOptions& options,
                    double nearest, Faces faces)
      : pair_(pair),
        motion_(motion),
        options_(options),
        nearest_(nearest),
        dilations_(pair.a.radius + pair.b.radius),
        speed_(motion.speed() + motion.spin() * radius_about(pair.a.complex, Vec3::Zero())),
        tau_(2e-9 * std::max(pair.a.bounding_radius, pair.b.bounding_radius)),
        rounding_(1e-14 * (pair.a.bounding_radius + pair.b.bounding_radius + dilations_ + options.threshold)),
        off_{2 * tau_, 2 * tau_} {
    if (faces == Faces::idealised) off_[0] += 2 * pair.a.tolerance, off_[1] += 2 * pair.b.tolerance;
  }

  /// Steps are so short that the bases cannot meet between two poses: contacts are defined for disjoint
  /// bases.
  void run(double t_end, int steps, ContinuityAudit& audit) const {
    double t0 = 0, d = distance(0);
    if (d < nearest_) return;
    ++audit.motions;
    ContactSet now = contacts(0);
    while (t0 < t_end) {
      const double t1 = t0 + std::min(t_end / steps, d / (2 * speed_));
      d = distance(t1);
      if (d < nearest_) return;
      ContactSet next = contacts(t1);
      ++audit.poses;
      audit.contacts += long(next.points.size());
      audit.nearest = std::min(audit.nearest, d);
      audit.farthest = std::max(audit.farthest, d);
      cover(next, d, t1, audit);
      for (const ContactPoint& c : now.points) {
        if (const ContactPoint* kept = find_key(next, key_of(c)))
          follow(c, t0, *kept, t1, audit);
        else
          classify(key_of(c), t0, t1, audit);
      }
      for (const ContactPoint& c : next.points)
        if (!find_key(now, key_of(c))) classify(key_of(c), t1, t0, audit);
      now = std::move(next);
      t0 = t1;
    }
  }

 private:
  enum class Why { unknown, threshold, angle, handover, dominated };

  // Sides are 0 for A, which moves, and 1 for B. Feet on the bases, world.
  struct Feet {
    std::array<Vec3, 2> x{};
    double d = 0;
  };
  // An event between two times, which are as near each other as times can be: the contact of A and B is there
  // at the first and not at the second.
  struct Event {
    ContactPoint contact{};
    Feet feet{};
    double there = 0, gone = 0;
    ContactSet without{};
  };

  const LmdShape& shape(int side) const { return side == 0 ? pair_.a : pair_.b; }
  PosedShape posed(int side, double t) const {
    return side == 0 ? PosedShape{&pair_.a, motion_.at(t), 0} : pair_.posed_b();
  }
  static const Feature& feature(const ContactPoint& c, int side) { return side == 0 ? c.a : c.b; }
  // Unit, from the foot of the side to the other.
  static Vec3 direction(const ContactPoint& c, int side) { return side == 0 ? Vec3(-c.normal) : c.normal; }
  double distance(double t) const {
    const double reach = 1.01 * (dilations_ + options_.threshold);
    return base_distance({&pair_.a, {}, {.g = motion_.at(t)}}, {&pair_.b, {}, {.g = pair_.g_b}}, reach);
  }
  ContactSet contacts(double t) const { return find_contacts(posed(0, t), posed(1, t), options_); }
  ContactKinematics kinematics(const ContactPoint& c, double t) const {
    return contact_kinematics(c, posed(0, t), motion_.at(t), posed(1, t), pair_.g_b);
  }
  double rate(const ContactPoint& c, double t) const {
    return kinematics(c, t).gap_rate.head<6>() * motion_.twist(t);
  }
  Feet feet_of(const ContactPoint& c) const {
    return {{c.x_a + pair_.a.radius * c.normal, c.x_b - pair_.b.radius * c.normal}, c.gap + dilations_};
  }
  // May there be a foot of p, at the distance `to`, that succeeds y at the distance d? (KIN-12)
  bool succeeds(int side, const Vec3& foot, double to, const Vec3& y, double d) const {
    const double eta = off_[side];
    return to <= d + eta && (foot - y).norm() <= eta + std::sqrt((d + eta) * (d + eta) - to * to);
  }
  bool same_feet(const Feet& a, const Feet& b, double within) const {
    return (a.x[0] - b.x[0]).norm() <= within && (a.x[1] - b.x[1]).norm() <= within;
  }

  // (LMD-14) of a pose.
  void cover(const ContactSet& set, double d, double t, ContinuityAudit& audit) const {
    const double gap = d - dilations_, tolerance = coverage_tolerance(posed(0, t), posed(1, t));
    if (gap > options_.threshold - tolerance || std::abs(smallest_gap(set) - gap) <= tolerance) return;
    ++audit.uncovered;
    ADD_FAILURE() << "smallest gap " << smallest_gap(set) << " where that of the bases is " << gap
                  << " at t = " << t;
  }

  // Along a track the gap is the integral of its rate. The trapezoidal rule is off by step^2 / 12 times its
  // second derivative, which for two vertices is at most 1.2 speed^3 / distance^2, where the motion itself
  // bends of order speed. Feet that slide fast, near parallel edges, have no useful second derivative.
  void follow(const ContactPoint& c, double t0, const ContactPoint& kept, double t1,
              ContinuityAudit& audit) const {
    const ContactKinematics k = kinematics(c, t0);
    if (k.sin_psi < 0.3) return;
    const double mean = (kept.gap - c.gap) / (t1 - t0), step = (t1 - t0) * (1 + speed_ / k.distance);
    const double rounding = 2 * tau_ / (t1 - t0);
    const double off = std::abs(mean - (rate(c, t0) + rate(kept, t1)) / 2) - rounding;
    audit.track = std::max(audit.track, off / (speed_ * step * step));
  }

  void classify(const ContactKey& key, double there, double gone, ContinuityAudit& audit) const {
    const Event event = narrowed(key, there, gone);
    const ContactPoint& c = event.contact;
    switch (why(event, audit)) {
      case Why::threshold:
        ++audit.at_threshold;
        return;
      case Why::angle:
        ++audit.at_angle;
        return;
      case Why::handover:
        ++audit.handovers;
        return;
      case Why::dominated:
        ++audit.dominated;
        return;
      case Why::unknown:
        break;
    }
    ++audit.unexplained;
    ADD_FAILURE() << "contact " << c.a.dim << '.' << c.a.region << " - " << c.b.dim << '.' << c.b.region
                  << (event.gone > event.there ? " vanishes" : " appears") << " at t = " << event.there
                  << " at a distance of " << event.feet.d << ", " << c.angle_margin
                  << " rad inside its cones; the nearest stays at "
                  << smallest_gap(event.without) + dilations_;
  }

  Event narrowed(const ContactKey& key, double there, double gone) const {
    ContactSet with = contacts(there), without = contacts(gone);
    while (std::abs(gone - there) > 1e-13) {
      const double middle = (there + gone) / 2;
      ContactSet set = contacts(middle);
      const bool is_there = find_key(set, key) != nullptr;
      (is_there ? there : gone) = middle;
      (is_there ? with : without) = std::move(set);
    }
    // Tests of feet on both sides of the event are to be no matter of rounding: a hundredth of their
    // tolerance beside it. Not before a crossing of edges ends, whose feet may slide at any speed.
    const double aside = std::copysign(1e-2 * tau_ / speed_, gone - there);
    if (ContactSet set = contacts(gone + aside); !find_key(set, key)) {
      gone += aside;
      without = std::move(set);
    }
    const ContactPoint* c = find_key(with, key);
    if (ContactSet set = contacts(there - aside); c->a.dim + c->b.dim != 2 || c->a.dim != 1)
      if (find_key(set, key)) {
        there -= aside;
        with = std::move(set);
        c = find_key(with, key);
      }
    return {*c, feet_of(*c), there, gone, std::move(without)};
  }

  Why why(const Event& event, ContinuityAudit& audit) const {
    const ContactPoint& c = event.contact;
    const double moved = 2 * speed_ * std::abs(event.gone - event.there);
    if (options_.threshold - c.gap < 10 * tau_ + rounding_ + moved) return Why::threshold;
    for (const ContactPoint& h : event.without.points)  // found twice, and the other one stays (LMD-10)
      if (same_feet(feet_of(h), event.feet, 10.1 * tau_)) return handed_over(event, h, audit);
    bool vanishes = false;
    Why last = Why::unknown;
    const auto is_explained = [&](Why of_this) {
      vanishes = true;
      last = of_this;
      return of_this != Why::unknown;
    };
    if (c.a.dim == 1 && c.b.dim == 1) {
      if (c.angle_margin < 1e-7) return Why::angle;
      for (const int side : {0, 1}) {
        const EdgeLeaf& chain = shape(side).edges[feature(c, side).region];
        for (const int v : {chain.first, chain.last}) {
          const Vec3 end = posed(side, event.there).g_ws * shape(side).complex.vertices[v];
          if ((end - event.feet.x[side]).norm() <= 20 * tau_ && !is_explained(why_foot_left(event, side, v)))
            return Why::unknown;
        }
      }
    } else {
      for (const int side : {0, 1}) {  // two vertices may be minima seen from either
        const Feature& f = feature(c, side);
        if (!is_minimum_of(event, side)) continue;
        const double angle = angle_at(side, f.simplex, event.there, direction(c, side));
        if (!is_explained(options_.alpha - angle < 1e-7 + turn_during(event)
                              ? Why::angle
                              : why_foot_left(event, side, f.simplex)))
          return Why::unknown;
      }
    }
    if (!vanishes || last == Why::angle) return last;
    const ContactPoint* heir = nullptr;
    for (const ContactPoint& h : event.without.points) {
      const Feet to = feet_of(h);
      if (std::abs(h.gap - c.gap) <= off_[0] + off_[1] &&
          succeeds(0, to.x[0], to.d, event.feet.x[0], event.feet.d) &&
          succeeds(1, to.x[1], to.d, event.feet.x[1], event.feet.d) &&
          (!heir || (h.normal - c.normal).norm() < (heir->normal - c.normal).norm()))
        heir = &h;
    }
    return heir ? handed_over(event, *heir, audit) : last;
  }

  Why handed_over(const Event& event, const ContactPoint& heir, ContinuityAudit& audit) const {
    const ContactPoint& c = event.contact;
    audit.handover_gap = std::max(audit.handover_gap, std::abs(heir.gap - c.gap));
    audit.handover_share = std::max(
        audit.handover_share, std::abs(heir.gap - c.gap) / (1.5 * std::max(off_[0], off_[1]) + 20 * tau_));
    audit.handover_turn = std::max(audit.handover_turn, (heir.normal - c.normal).norm());
    audit.handover_rate =
        std::max(audit.handover_rate, std::abs(rate(heir, event.gone) - rate(c, event.there)));
    return Why::handover;
  }

  // How far directions of a vertex turn while an event is narrowed [rad].
  double turn_during(const Event& event) const {
    return 2 * std::abs(event.gone - event.there) * (speed_ / event.feet.d + motion_.spin());
  }

  // All local minima of the distance of a point from a shape, up to a distance.
  ContactSet minima_of(const Vec3& p, const PosedShape& body, double distance) const {
    const PosedShape point{&point_, translation(p.x(), p.y(), p.z()), 2};
    return find_contacts(point, body,
                         {.threshold = std::max(0.0, distance - body.shape->radius), .alpha = 0});
  }
  // Between u and the normal cone of a vertex; infinite if the vertex is silent.
  double angle_at(int side, int vertex, double t, const Vec3& u) const {
    const auto& leaves = shape(side).vertices;
    const auto leaf = std::ranges::find(leaves, vertex, &VertexLeaf::vertex);
    if (leaf == leaves.end()) return kInf;
    const LeafId id{std::int32_t(leaf - leaves.begin()), 0, 1};
    return angle_to(cone_of(leaf_of(shape(side), id)), posed(side, t).g_ws.R.conjugate() * u);
  }
  // Does an edge of the vertex lead towards u? If none does, u is in its normal cone, whatever cones say.
  bool is_descent(int side, int vertex, double t, const Vec3& u) const {
    const SimplicialComplex& k = shape(side).complex;
    const Vec3 own = posed(side, t).g_ws.R.conjugate() * u;
    return std::ranges::any_of(k.vertex_edges[vertex], [&](int e) {
      const auto& ends = k.edges[e];
      const int other = ends[0] == vertex ? ends[1] : ends[0];
      return own.dot(k.vertices[other] - k.vertices[vertex]) > 0;
    });
  }
  // Was the contact one of the side's vertex, whose exact minimum on the other body it is? Of two vertices
  // either may be, or both.
  bool is_minimum_of(const Event& event, int side) const {
    const ContactPoint& c = event.contact;
    const Feature &own = feature(c, side), &other = feature(c, 1 - side);
    if (own.dim != 0) return false;
    if (other.dim != 0) return true;
    if (angle_at(side, own.simplex, event.there, direction(c, side)) > options_.alpha) return false;
    const auto& leaves = shape(1 - side).vertices;
    const auto leaf = std::ranges::find(leaves, other.simplex, &VertexLeaf::vertex);
    const Vec3 to_vertex =
        posed(1 - side, event.there).g_ws.R.conjugate() * (-event.feet.d * direction(c, side));
    return std::ranges::all_of(leaf_of(shape(1 - side), {std::int32_t(leaf - leaves.begin()), 0, 1}).rays,
                               [&](const Vec3& g) { return g.dot(to_vertex) <= 1.1 * tau_; });
  }

  // A vertex of `side` is where the contact's foot was, and sees the other foot leave its simplex. There must
  // be a successor; all minima that the vertex has there are contacts, unless they are out of its angle; and
  // where none of them succeeds, something is nearer.
  Why why_foot_left(const Event& event, int side, int vertex) const {
    const int other = 1 - side;
    const double t = event.gone;
    const PosedShape body = posed(side, t), onto = posed(other, t);
    const Vec3 p = body.g_ws * body.shape->complex.vertices[vertex];
    const Vec3 x = onto.g_ws * (inverse(posed(other, event.there).g_ws) * event.feet.x[other]);
    const Vec3 y = end_of_descent(event.contact, other, onto, x, p);
    const double d_x = event.feet.d, d_y = (y - p).norm();
    bool has_successor = false;
    for (const ContactPoint& m : minima_of(p, onto, d_x + off_[other]).points) {
      Feet to;
      to.d = m.gap + onto.shape->radius;
      to.x[side] = p;
      to.x[other] = m.x_b - onto.shape->radius * m.normal;
      const double angle = angle_at(side, vertex, t, -m.normal);
      if (angle > options_.alpha && !is_descent(side, vertex, t, -m.normal)) return Why::unknown;
      const bool is_due =
          angle <= options_.alpha - 2 * tau_ / to.d && to.d - dilations_ <= options_.threshold - 20 * tau_;
      if (is_due && std::ranges::none_of(event.without.points, [&](const ContactPoint& h) {
            return same_feet(feet_of(h), to, 20 * tau_);
          }))
        return Why::unknown;
      const Vec3& foot = to.x[other];
      has_successor =
          has_successor || succeeds(other, foot, to.d, x, d_x) || succeeds(other, foot, to.d, y, d_y);
    }
    const bool is_nearer = smallest_gap(event.without) <= event.contact.gap + off_[0] + off_[1];
    return has_successor && is_nearer ? Why::dominated : Why::unknown;
  }

  // From the foot x of a contact down to p, world.
  Vec3 end_of_descent(const ContactPoint& c, int side, const PosedShape& body, const Vec3& x,
                      const Vec3& p) const {
    const SimplicialComplex& k = body.shape->complex;
    const Feature& f = feature(c, side);
    std::vector<int> at;
    if (f.dim == 2) at = {f.simplex};
    if (f.dim == 1) at.assign(k.edge_triangles[f.simplex].begin(), k.edge_triangles[f.simplex].end());
    if (f.dim == 0) at.assign(k.vertex_triangles[f.simplex].begin(), k.vertex_triangles[f.simplex].end());
    const SE3 back = inverse(body.g_ws);
    return body.g_ws * descend(k, at, back * x, back * p, off_[side]);
  }

  LmdShape point_ = prepare(dilate(make_point(), 0));
  const RandomPair& pair_;
  const SmoothMotion& motion_;
  const LmdOptions& options_;
  double nearest_ = 0, dilations_ = 0, speed_ = 0;
  double tau_ = 0, rounding_ = 0;  // tolerance of feet; of distances [m]
  std::array<double, 2> off_{};    // eta of (KIN-12), of each shape [m]
};

inline void print(const std::string& what, const ContinuityAudit& a) {
  std::printf(
      "%s%ld motions, %ld poses at %.1e to %.1e m, %ld contacts; events: %ld at the threshold, %ld at the "
      "angle, %ld handovers (jump of the gap %.1e m, of its rate %.1e, of the normal %.1e), %ld dominated, "
      "%ld "
      "unexplained; %ld poses uncovered; rate along tracks off by %.2g\n",
      what.c_str(), a.motions, a.poses, a.nearest, a.farthest, a.contacts, a.at_threshold, a.at_angle,
      a.handovers, a.handover_gap, a.handover_rate, a.handover_turn, a.dominated, a.unexplained, a.uncovered,
      a.track);
}

/// `motions` random motions of convex and L-shaped pairs, `steps` poses each. Prints the seed of each
/// failure.
inline ContinuityAudit audit_continuity(unsigned first_seed, int motions, int steps) {
  ContinuityAudit audit;
  for (unsigned seed = first_seed; seed < first_seed + unsigned(motions); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomPair pair = random_pair(seed, 0.12);
    Random random(seed + 100000);
    const SmoothMotion motion{.g = pair.g_a,
                              .sway = random.vector(0.08),
                              .turn = random.vector(seed % 2 ? 0.05 : 0.3),
                              .phase = random.vector(3)};
    const LmdOptions options{.threshold = random.uniform(0.1, 0.25)};
    ContinuityAuditor(pair, motion, options, 0.03, Faces::exact).run(6, steps, audit);
  }
  print("", audit);
  return audit;
}

}  // namespace aussois
