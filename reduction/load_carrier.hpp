// SPDX-License-Identifier: Apache-2.0
// The at most three contacts of a patch that can carry what it carried in the last step (RED-13).
#pragma once

#include <span>

#include "reduction/planar_patch.hpp"

namespace aussois {

/// `load[i]`: normal impulse or force of member i, >= 0 but for rounding; members without load weigh nothing.
/// Members, ascending. While the loaded members are three or fewer corners of one triangle they stay;
/// otherwise those of the corners of the hull whose triangle holds the centre of pressure and lies farthest
/// out. Without a load the whole hull.
std::vector<int> load_carrier(const PlanarPatch& patch, std::span<const double> load);

}  // namespace aussois
