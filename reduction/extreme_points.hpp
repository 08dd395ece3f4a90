// SPDX-License-Identifier: Apache-2.0
// Four extremes along two in-plane axes [Moravanszky2004]; the tie rule is ours (RED-3).
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// At most four members, ascending. `tie`: extremes within this fraction of the extent are tied. With
/// `paper_exact` the first of tied extremes wins, as published; an aligned rectangle then loses a corner.
std::vector<int> extreme_points(const PlanarPatch& patch, double tie, bool paper_exact = false);

}  // namespace aussois
