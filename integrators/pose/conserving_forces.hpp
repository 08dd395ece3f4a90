// SPDX-License-Identifier: Apache-2.0
// Forces at the middle of a step whose work on its path is the change of their potential (PMI-9) to (PMI-12).
#pragma once

#include <vector>

#include "integrators/pose/step_setting.hpp"
#include "mechanics/forces.hpp"

namespace aussois {

/// Impulses of force laws, joint axes and coordinates over a step, laid out and linear in the velocities at
/// its end as in FreeMotion.
struct MiddleForces {
  VecX laws{};
  SparseMatrix law_D{};
  std::vector<AxisImpulse> axes{};
};
/// About the path that the `mean` velocities give in a step that starts at `start` with the velocities `v`;
/// `mean` and `v` in the rows of the problem, `v_prescribed` laid out as State::v.
MiddleForces conserving_forces(const StepSetting& setting, const State& start, const SparseMatrix& mass,
                               const VecX& v, const VecX& mean, const VecX& v_prescribed, double h);

}  // namespace aussois
