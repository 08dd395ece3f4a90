// SPDX-License-Identifier: Apache-2.0
// Looks along a step at the pairs of leaves that can become minima of distance (CA-21).
#pragma once

#include "lmd/simplex_motion.hpp"

namespace aussois {

/// Whether (CA-21) can say something: the coverage of both shapes is proven, neither deforms, they turn by no
/// more than cones can be enlarged by, and the required distance is half of the dilations or more.
bool has_step_minima(const MovingShape& a, const MovingShape& b, double dt, double required);

/// If it has not failed, its min_distance bounds the distance of the bases along the whole step from below,
/// provided that they are apart at the start and that neither is inside the other. A failure says nothing.
PartialCheck check_step_minima(const MovingShape& a, const MovingShape& b, double dt,
                               const DistanceGoal& goal, int threads);

}  // namespace aussois
