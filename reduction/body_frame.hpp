// SPDX-License-Identifier: Apache-2.0
// A frame about a direction that turns with a body, so that what is computed in it depends only on relative
// poses (RED-3), (RED-12).
#pragma once

#include "lmd/contact_point.hpp"

namespace aussois {

/// A right-handed frame with columns n, t, n x t; n must be a unit vector. t is the column of `axes` (the
/// axes of the body, in the world) most nearly perpendicular to n, projected. Of tied axes the first is
/// taken, so that rounding does not choose.
inline Mat3 body_frame(const Vec3& n, const Mat3& axes) {
  constexpr double kSameAxis = 1e-6;  // difference of cosines up to which axes are tied
  const Vec3 along = (axes.transpose() * n).cwiseAbs();
  int across = 0;
  while (along[across] > along.minCoeff() + kSameAxis) ++across;
  const Vec3 t = (axes.col(across) - n.dot(axes.col(across)) * n).normalized();
  Mat3 frame;
  frame << n, t, n.cross(t);
  return frame;
}

}  // namespace aussois
