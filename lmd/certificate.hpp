// SPDX-License-Identifier: Apache-2.0
// Proves that two base complexes keep their distance along a whole step (CA-6) to (CA-8): every pair of
// simplices that could come near is separated by a plane at all times of the step. Uses no normal cones and
// no classes, unless the caller knows that the bases start apart (CA-21).
#pragma once

#include "lmd/moving_shape.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct CertificateOptions {
  double required = 0;    // distance that must never be undercut [m]
  double wanted = 0;      // pairs certain to stay farther apart are not examined further [m], >= required
  int max_halvings = 12;  // of the time interval of a pair of simplices before the pair counts as failed
  int threads = 1;
  // Direction from a to b, world, tried first, for both shapes as a whole: any direction is safe, and a
  // contact's normal settles convex shapes (CA-15). Zero: none.
  Vec3 axis = Vec3::Zero();
  // The caller knows that the bases are apart at the start and that neither is inside the other: then only
  // pairs that can become minima of distance and those with LmdShape::unproven are looked at, where that is
  // enough (CA-21)
  bool starts_apart = false;
};
void describe(SettingVisitor& visit, CertificateOptions& options);  // all but the last two

struct Certificate {
  bool certified = false;
  double min_distance = kInf;  // lower bound over the step if certified, at most `wanted` [m]
  long simplex_pairs = 0;      // examined
  long rounds = 0;             // time intervals over which pairs were examined
};

/// Throws std::invalid_argument for a bad option.
Certificate certify(const MovingShape& a, const MovingShape& b, double dt, const CertificateOptions& options);

struct BaseDistance {
  double distance = kInf;     // [m]
  long simplex_pairs = 0;     // examined
  Vec3 place = Vec3::Zero();  // where A is that near, world [m]; meaningless at the cutoff
};

/// Smallest distance of the base complexes at s = 0 [m], if it is below `cutoff`; otherwise `cutoff`. Pairs
/// certainly farther apart than the smallest distance so far are skipped: where surfaces conform, a cutoff
/// near the distance saves most of the work.
BaseDistance find_base_distance(const MovingShape& a, const MovingShape& b, double cutoff, int threads = 1);
/// `find_base_distance(...).distance` [m].
double base_distance(const MovingShape& a, const MovingShape& b, double cutoff, int threads = 1);

}  // namespace aussois
