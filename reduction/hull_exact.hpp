// SPDX-License-Identifier: Apache-2.0
// All corners of the hull: nothing is lost except what rounding hides (RED-1).
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

/// Members, ascending.
std::vector<int> hull_exact(const PlanarPatch& patch);

}  // namespace aussois
