// SPDX-License-Identifier: Apache-2.0
// A few corners of the hull that keep much of its area (RED-10): the rigorous variant of [Moravanszky2004].
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// At most `corners` >= 3 members, ascending. For four, the largest quadrilateral; otherwise what is left
/// after repeatedly removing the corner whose triangle with its neighbours is smallest.
std::vector<int> hull_area_loss(const PlanarPatch& patch, int corners);

/// Each of the two rules by itself, applied to the corners of the hull.
std::vector<int> largest_quadrilateral(const PlanarPatch& patch);
std::vector<int> least_area_removed(const PlanarPatch& patch, int corners);

}  // namespace aussois
