// SPDX-License-Identifier: Apache-2.0
// The extremes of a fan of in-plane directions; four of them are those of [Moravanszky2004] (RED-3).
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// Members, at most `directions` >= 3, ascending. The first direction is the principal one. A disc keeps a
/// margin of cos(pi / directions), other shapes what they happen to. `tie` as of extreme_points.
std::vector<int> direction_set(const PlanarPatch& patch, int directions, double tie);

}  // namespace aussois
