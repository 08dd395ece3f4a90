// SPDX-License-Identifier: Apache-2.0
// The peer for the set of contacts: pairs of triangles near each other, as CGAL's AABB tree enumerates them.
// Links a GPL part of CGAL: only with AUSSOIS_WITH_GPL (doc/decisions/0011-a-benchmark-asks-a-gpl-peer.md).
#pragma once

#include <memory>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

class CgalPair {
 public:
  /// A tree on B. Refers to A.
  CgalPair(const SimplicialComplex& a, const SimplicialComplex& b);
  ~CgalPair();

  /// Pairs of a triangle of B and the box of a triangle of A, grown by `reach` [m], that meet; A posed in the
  /// frame of B. All pairs at most `reach` apart are among them; nothing is done with them, so this is the
  /// least that any enumeration of pairs costs here.
  long count_near(const SE3& g_ba, double reach) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aussois
