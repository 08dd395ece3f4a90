// SPDX-License-Identifier: Apache-2.0
// Looks along a step at the pairs of leaves that can become minima of distance (CA-21).
#pragma once

#include "lmd/simplex_motion.hpp"

namespace aussois {

/// Whether (CA-21) says something and costs less than all pairs: the coverage of both shapes is proven for
/// three simplices of four or more, neither deforms, they turn by no more than cones can be enlarged by, and
/// the required distance is half of the dilations or more.
bool has_step_minima(const MovingShape& a, const MovingShape& b, double dt, double required);

/// t of (CA-21): how much nearer than all these pairs the bases may be [m].
double minima_slack(const MovingShape& a, const MovingShape& b);

/// If it has not failed, its min_distance bounds the distance of the bases along the whole step from below,
/// provided that they are apart at the start, that neither is inside the other, and that all pairs with
/// LmdShape::unproven stay farther apart by `minima_slack`. A failure says nothing.
PartialCheck check_step_minima(const MovingShape& a, const MovingShape& b, double dt,
                               const DistanceGoal& goal, int threads);

}  // namespace aussois
