// SPDX-License-Identifier: Apache-2.0
// A frame about a direction that turns with a body: what depends on it is a function of relative poses alone
// (RED-3), (RED-12).
#pragma once

#include "lmd/contact_point.hpp"

namespace aussois {

/// Columns n, t, n x t, right-handed; n must be unit. t is the one of `axes` (columns, of the body, world)
/// that is most across n, projected; of several that are, the first, so that rounding does not choose.
inline Mat3 body_frame(const Vec3& n, const Mat3& axes) {
  constexpr double kSameAxis = 1e-6;  // of cosines: axes as far across n as others
  const Vec3 along = (axes.transpose() * n).cwiseAbs();
  int across = 0;
  while (along[across] > along.minCoeff() + kSameAxis) ++across;
  const Vec3 t = (axes.col(across) - n.dot(axes.col(across)) * n).normalized();
  Mat3 frame;
  frame << n, t, n.cross(t);
  return frame;
}

}  // namespace aussois
