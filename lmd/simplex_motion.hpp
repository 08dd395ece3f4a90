// SPDX-License-Identifier: Apache-2.0
// Proves of one pair of simplices that it keeps its distance along a step (CA-7).
#pragma once

#include <span>

#include "lmd/moving_shape.hpp"

namespace aussois {

/// A body at some time of the step, seen from the world: what the separation bound needs of it.
struct Instant {
  Mat3 R = Mat3::Identity();  // shape frame to world
  Vec3 t = Vec3::Zero();
  Vec3 centre = Vec3::Zero();               // reference point, world
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  // world
  double since = 0;                         // the start of the step [s]
};
Instant at_time(const MovingShape& m, double s);

/// Largest speed of a vertex in the frame of the shape [m/s].
double largest_speed(const MovingShape& m);

struct MovingSimplex {
  Vec3 x[3], v[3];  // vertices and their velocities, world
  int count = 0;
  double bend = 0;                                   // bound of |d^2 x / ds^2|
  Vec3 centre = Vec3::Zero(), drift = Vec3::Zero();  // mean of the vertices, its velocity
  double radius = 0;                                 // of the simplex about its centre, all the time
  std::span<const Vec3> points() const { return {x, std::size_t(count)}; }
};
MovingSimplex moving(const MovingShape& m, const BaseSimplex& simplex, const Instant& now, double dt);

/// What is to be proven of every pair of simplices.
struct DistanceGoal {
  double required = 0;    // distance that must never be undercut [m]
  double wanted = 0;      // pairs certain to stay farther apart are not examined further [m], >= required
  int max_halvings = 12;  // of the time interval before the pair counts as failed
};

/// What one part of a search for pairs finds.
struct PartialCheck {
  bool failed = false;
  double min_distance = kInf;
  double seen = kInf;  // if it failed: the least distance of two simplices that was seen at some time
  long simplex_pairs = 0, rounds = 0;
};

void add(const PartialCheck& part, PartialCheck& all);
/// Whether two simplices were seen nearer than `distance`, beyond rounding.
bool is_seen_nearer(const PartialCheck& part, double distance);

/// The shapes must outlive it.
class SimplexPairCheck {
 public:
  SimplexPairCheck(const MovingShape& a, const MovingShape& b, double dt, const DistanceGoal& goal);

  /// Balls around points of the bodies: only their centres move (CA-8).
  bool far(const MovingSimplex& p, const MovingSimplex& q) const;

  /// `p` and `q` are the simplices at the start of the step.
  void check(const BaseSimplex& of_a, const BaseSimplex& of_b, const MovingSimplex& p, const MovingSimplex& q,
             PartialCheck& part) const;

  MovingSimplex start_a(const BaseSimplex& simplex) const { return moving(a_, simplex, a0_, dt_); }
  MovingSimplex start_b(const BaseSimplex& simplex) const { return moving(b_, simplex, b0_, dt_); }
  const Instant& now_a() const { return a0_; }
  const Instant& now_b() const { return b0_; }
  const MovingShape& a() const { return a_; }
  const MovingShape& b() const { return b_; }
  double dt() const { return dt_; }
  double wanted() const { return goal_.wanted; }

 private:
  struct Pair {
    const BaseSimplex &a, &b;
  };
  void check_interval(const Pair& pair, double s0, double s1, int halvings, const MovingSimplex& p,
                      const MovingSimplex& q, PartialCheck& part) const;
  bool ends_too_near(const Pair& pair, PartialCheck& part) const;

  const MovingShape &a_, &b_;
  double dt_;
  DistanceGoal goal_;
  Instant a0_, b0_;
};

}  // namespace aussois
