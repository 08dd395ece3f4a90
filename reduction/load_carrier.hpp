// SPDX-License-Identifier: Apache-2.0
// Selects at most three contacts of a patch that can carry what the patch carried in the last step (RED-13).
#pragma once

#include <span>

#include "reduction/planar_patch.hpp"

namespace aussois {

/// `load[i]`: normal impulse or force of member i, >= 0 up to rounding; members without load do not count.
/// Returns members, ascending. Loaded members stay if there are at most three of them, all corners of the
/// hull. Otherwise the result is the corners of the hull whose triangle contains the centre of pressure and
/// lies farthest out. Without a load, it is the whole hull.
std::vector<int> load_carrier(const PlanarPatch& patch, std::span<const double> load);

}  // namespace aussois
