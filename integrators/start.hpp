// SPDX-License-Identifier: Apache-2.0
// The door of a run: can a scheme begin at this state?
#pragma once

#include "integrators/advancement.hpp"

namespace aussois {

/// Throws std::invalid_argument naming what is wrong, its value and its bound: what validate(model, state)
/// refuses; bodies whose base complexes are nearer than the certificate will allow (CA-6); a body inside the
/// solid of another (CA-19), which no step after the first looks for; a joint that is off by
/// more than `joint_tolerance` [m, rad] (`consistent` mends that); a block or gap function whose matrices
/// have the wrong size, or whose mass is not symmetric and positive definite.
void validate_start(const Model& model, const State& state, const AdvancementOptions& options = {},
                    double joint_tolerance = 1e-6);

}  // namespace aussois
