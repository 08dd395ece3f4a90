// SPDX-License-Identifier: Apache-2.0
// A few corners of the hull that keep much of its area (RED-10): the rigorous variant of [Moravanszky2004].
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// Members, at most `corners` >= 3, ascending: for four the largest quadrilateral, otherwise what is left
/// when the corner whose triangle with its neighbours is smallest is removed again and again.
std::vector<int> hull_area_loss(const PlanarPatch& patch, int corners);

/// Both by themselves, of the corners of the hull.
std::vector<int> largest_quadrilateral(const PlanarPatch& patch);
std::vector<int> least_area_removed(const PlanarPatch& patch, int corners);

}  // namespace aussois
