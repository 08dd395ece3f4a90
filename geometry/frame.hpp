// SPDX-License-Identifier: Apache-2.0
// Makes the frame of a direction, always the same for the same direction (MJ-3); Duff et al. 2017.
#pragma once

#include <cmath>

#include "geometry/types.hpp"

namespace aussois {

/// Columns n, t1, t2: orthonormal, right-handed; n must be unit.
inline Mat3 frame_of(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  Mat3 frame;
  frame << n, Vec3(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
      Vec3(b, sign + n.y() * n.y() * a, -n.y());
  return frame;
}

}  // namespace aussois
