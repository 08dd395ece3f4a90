// SPDX-License-Identifier: Apache-2.0
// What is lost with the contacts that were left out (RED-7) to (RED-9).
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/types.hpp"

namespace aussois {

/// The kept contacts of one patch compared with the whole patch; for several patches, the worst value of each
/// field.
struct LossReport {
  double margin = 1;   // least ratio of the support functions about the centroid; 1: nothing lost, <= 0: the
                       // centroid is unsupported, -kInf: no contact is left
  double area = 1;     // ratio of the hull areas, in [0, 1]; patches without area do not count
  double depth = 0;    // how much deeper the deepest contact is than the deepest kept one [m], >= 0
  double torsion = 1;  // drilling torque of Coulomb friction at the kept points, equally loaded, divided by
                       // that of even pressure on the patch; the worst is the farthest from 1 on a log scale
  double hausdorff = 0;  // Hausdorff distance of the two hulls [m]
};

/// The worse of the two, field by field.
inline LossReport worst_loss(const LossReport& a, const LossReport& b) {
  const auto off = [](double torsion) { return torsion > 0 ? std::abs(std::log(torsion)) : kInf; };
  return {.margin = std::min(a.margin, b.margin),
          .area = std::min(a.area, b.area),
          .depth = std::max(a.depth, b.depth),
          .torsion = off(b.torsion) > off(a.torsion) ? b.torsion : a.torsion,
          .hausdorff = std::max(a.hausdorff, b.hausdorff)};
}

}  // namespace aussois
