// SPDX-License-Identifier: Apache-2.0
// How often a surface goes round a point, by solid angles: an oracle that knows no rays.
#pragma once

#include <cmath>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// In parts of the full solid angle [vanOosterom1983].
inline double winding_number(const SimplicialComplex& solid, const Vec3& p) {
  double sum = 0;
  for (const auto& [i, j, k] : solid.triangles) {
    const Vec3 a = solid.vertices[i] - p, b = solid.vertices[j] - p, c = solid.vertices[k] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (2 * kPi);
}

}  // namespace aussois
