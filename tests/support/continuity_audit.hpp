// SPDX-License-Identifier: Apache-2.0
// Why contacts come and go along a smooth motion: every event is brought to its instant by bisection and
// classified as (KIN-11) says. Anything else is unexplained, and a bug.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "lmd/contact_kinematics.hpp"
#include "lmd/normal_cone.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {

/// Counts of events, and the worst that was seen.
struct ContinuityAudit {
  long poses = 0, contacts = 0, at_threshold = 0, at_angle = 0, handovers = 0, dominated = 0, unexplained = 0;
  double handover_gap = 0, handover_rate = 0;  // jumps of gap [m] and of gap_rate
  double track_rate = 0;  // | mean rate over a step - mean of gap_rate xi at its ends | / step^2, while kept
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
};

inline const ContactPoint* find_key(const ContactSet& set, const ContactKey& key) {
  for (const ContactPoint& c : set.points)
    if (key_of(c) == key) return &c;
  return nullptr;
}

class ContinuityAuditor {
 public:
  ContinuityAuditor(const RandomPair& pair, const SmoothMotion& motion, const LmdOptions& options)
      : pair_(pair), motion_(motion), options_(options) {}

  /// Ends where the bases come nearer than a step may take them: contacts are defined for disjoint bases.
  void run(double t_end, int steps, ContinuityAudit& audit) const {
    ContactSet now = contacts(0);
    for (int i = 0; i < steps; ++i) {
      const double t0 = t_end * i / steps, t1 = t_end * (i + 1) / steps;
      const SE3 g = motion_.at(t1);
      if (base_distance({&pair_.a, {}, {.g = g}}, {&pair_.b, {}, {.g = pair_.g_b}}, 1) < 0.03) return;
      ContactSet next = contacts(t1);
      ++audit.poses;
      audit.contacts += long(next.points.size());
      for (const ContactPoint& c : now.points) {
        if (const ContactPoint* kept = find_key(next, key_of(c)))
          follow(c, t0, *kept, t1, audit);
        else
          classify(key_of(c), t0, t1, audit);
      }
      for (const ContactPoint& c : next.points)
        if (!find_key(now, key_of(c))) classify(key_of(c), t1, t0, audit);
      now = std::move(next);
    }
  }

 private:
  ContactSet contacts(double t) const {
    return find_contacts({&pair_.a, motion_.at(t), 0}, pair_.posed_b(), options_);
  }
  double rate(const ContactPoint& c, double t) const {
    const SE3 g = motion_.at(t);
    const Row12 row = contact_kinematics(c, {&pair_.a, g, 0}, g, pair_.posed_b(), pair_.g_b).gap_rate;
    return row.head<6>() * motion_.twist(t);
  }

  // Along a track the gap is the integral of its rate: the trapezoidal rule, O(step^2). Feet that slide fast,
  // near parallel edges, have no useful second derivative over a step.
  void follow(const ContactPoint& c, double t0, const ContactPoint& kept, double t1,
              ContinuityAudit& audit) const {
    const SE3 g = motion_.at(t0);
    const ContactKinematics k = contact_kinematics(c, {&pair_.a, g, 0}, g, pair_.posed_b(), pair_.g_b);
    if (k.sin_psi < 0.3 || k.distance < 0.05) return;
    const double mean = (kept.gap - c.gap) / (t1 - t0);
    audit.track_rate = std::max(
        audit.track_rate, std::abs(mean - (rate(c, t0) + rate(kept, t1)) / 2) / ((t1 - t0) * (t1 - t0)));
  }

  // The contact is there at `there` and not at `gone`, before or after it.
  void classify(const ContactKey& key, double there, double gone, ContinuityAudit& audit) const {
    ContactSet with = contacts(there), without = contacts(gone);
    for (int i = 0; i < 60 && std::abs(gone - there) > 1e-13; ++i) {
      const double middle = (there + gone) / 2;
      ContactSet set = contacts(middle);
      const bool is_there = find_key(set, key) != nullptr;
      (is_there ? there : gone) = middle;
      (is_there ? with : without) = std::move(set);
    }
    const ContactPoint& c = *find_key(with, key);
    const double d = c.gap + pair_.a.radius + pair_.b.radius;
    if (options_.threshold - c.gap < 1e-9) {
      ++audit.at_threshold;
      return;
    }
    if (c.angle_margin < 1e-7) {
      ++audit.at_angle;
      return;
    }
    for (const ContactPoint& heir : without.points)
      if ((heir.x_a - c.x_a).norm() < 1e-6 && (heir.x_b - c.x_b).norm() < 1e-6 &&
          (heir.normal - c.normal).norm() < 1e-6) {
        ++audit.handovers;
        audit.handover_gap = std::max(audit.handover_gap, std::abs(heir.gap - c.gap));
        audit.handover_rate = std::max(audit.handover_rate, std::abs(rate(heir, gone) - rate(c, there)));
        return;
      }
    const double nearest = smallest_gap(without) + pair_.a.radius + pair_.b.radius;
    // A foot has reached a vertex. A little later, would the pair of that vertex be a contact by the rule?
    const double later = gone + std::copysign(1e-6, gone - there);
    const PosedShape a{&pair_.a, motion_.at(later), 0}, b = pair_.posed_b();
    const Vec3 foot_a = a.g_ws * (inverse(motion_.at(there)) * Vec3(c.x_a + pair_.a.radius * c.normal)),
               foot_b = c.x_b - pair_.b.radius * c.normal;
    const double angle_a = angle_at_vertex(a, foot_a, -c.normal),
                 angle_b = angle_at_vertex(b, foot_b, c.normal);
    const auto within = [&](double angle) { return angle >= 0 && angle <= options_.alpha; };
    const bool heir_due = (within(angle_a) && is_nearest_around(foot_a, b, foot_b)) ||
                          (within(angle_b) && is_nearest_around(foot_b, a, foot_a));
    if (nearest < d && (angle_a >= 0 || angle_b >= 0) && !heir_due) {
      ++audit.dominated;
      return;
    }
    ++audit.unexplained;
    ADD_FAILURE() << "contact " << c.a.dim << '.' << c.a.region << " - " << c.b.dim << '.' << c.b.region
                  << (gone > there ? " vanishes" : " appears") << " at t = " << there << " at a distance of "
                  << d << ", " << c.angle_margin << " rad inside its cones; the nearest stays at " << nearest;
  }

  // Angle between u and the normal cone of the vertex at `foot`, infinite if the vertex is silent; -1 if
  // there is none. From the edges that meet there: no vertex of our shapes is a pit.
  static double angle_at_vertex(const PosedShape& posed, const Vec3& foot, const Vec3& u) {
    const SimplicialComplex& k = posed.shape->complex;
    for (int v = 0; v < int(k.vertices.size()); ++v) {
      const Vec3& x = k.vertices[std::size_t(v)];
      if ((posed.g_ws * x - foot).norm() > 1e-6) continue;
      std::vector<Vec3> directions;
      for (const int e : k.vertex_edges[v]) {
        const auto& ends = k.edges[std::size_t(e)];
        directions.push_back(k.vertices[std::size_t(ends[0] == v ? ends[1] : ends[0])] - x);
      }
      const NormalCone cone = make_normal_cone(directions);
      return cone.lineality == 0 || directions.size() < 3 ? angle_to(cone, posed.g_ws.R.conjugate() * u)
                                                          : kInf;
    }
    return -1;
  }
  // Is `foot` a local minimum of the distance from the point p to the body, exactly?
  bool is_nearest_around(const Vec3& p, const PosedShape& body, const Vec3& foot) const {
    const PosedShape point{&point_, translation(p.x(), p.y(), p.z()), 2};
    const ContactSet minima = find_contacts(point, body, {.threshold = 1, .alpha = 0});
    return std::ranges::any_of(minima.points, [&](const ContactPoint& c) {
      return (c.x_b - body.shape->radius * c.normal - foot).norm() < 1e-5;
    });
  }

  LmdShape point_ = prepare(dilate(make_point(), 0));
  const RandomPair& pair_;
  const SmoothMotion& motion_;
  const LmdOptions& options_;
};

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
    ContinuityAuditor(pair, motion, options).run(6, steps, audit);
  }
  std::printf(
      "%ld poses, %ld contacts; events: %ld at the threshold, %ld at the angle, %ld handovers (jump of "
      "the gap %.1e m, of its rate %.1e), %ld dominated, %ld unexplained; rate along tracks off by "
      "%.1e step^2\n",
      audit.poses, audit.contacts, audit.at_threshold, audit.at_angle, audit.handovers, audit.handover_gap,
      audit.handover_rate, audit.dominated, audit.unexplained, audit.track_rate);
  return audit;
}

}  // namespace aussois
