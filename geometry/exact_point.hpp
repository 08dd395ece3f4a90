// SPDX-License-Identifier: Apache-2.0
// Points of CGAL's kernel whose predicates have exact signs.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "geometry/types.hpp"

namespace aussois {

using ExactKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

inline ExactKernel::Point_2 exact(const Vec2& x) {
  return {x.x(), x.y()};
}
inline ExactKernel::Point_3 exact(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}

}  // namespace aussois
