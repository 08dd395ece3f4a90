// SPDX-License-Identifier: Apache-2.0
// How far points of one surface are from another: a lower bound of the largest distance.
#pragma once

#include <algorithm>

#include "geometry/surface_tree.hpp"
#include "tests/support/random.hpp"

namespace aussois {

inline double sampled_distance(const SimplicialComplex& from, const SimplicialComplex& to,
                               int points = 20000) {
  const SurfaceTree tree(to);
  Random random(3);
  double out = 0;
  for (int i = 0; i < points; ++i) {
    const auto& [a, b, c] = from.triangles[std::size_t(i) % from.triangles.size()];
    double s = random.uniform(0, 1), t = random.uniform(0, 1);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3 &x = from.vertices[a], &y = from.vertices[b], &z = from.vertices[c];
    out = std::max(out, tree.nearest(x + s * (y - x) + t * (z - x)).distance);
  }
  return out;
}

}  // namespace aussois
