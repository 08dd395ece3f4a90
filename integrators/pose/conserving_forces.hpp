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
  VecX missing{};  // part of `laws`: what (PMI-10) adds
};
/// Where a step is thought to lead.
struct MiddleMotion {
  VecX v{}, mean{};     // velocities at its start and their mean with those at its end, rows of the problem
  VecX v_prescribed{};  // laid out as State::v
  VecX missing{};       // of an earlier guess, to be kept; empty: it is computed
};
MiddleForces conserving_forces(const StepSetting& setting, const State& start, const SparseMatrix& mass,
                               const MiddleMotion& motion, double h);

}  // namespace aussois
