// SPDX-License-Identifier: Apache-2.0
// The extremes along a fan of in-plane directions; with four directions, those of [Moravanszky2004] (RED-3).
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// At most `directions` >= 3 members, ascending. The first direction is the principal one. A disc keeps a
/// margin of cos(pi / directions); for other shapes no margin is guaranteed. `tie` as for extreme_points.
std::vector<int> direction_set(const PlanarPatch& patch, int directions, double tie);

}  // namespace aussois
