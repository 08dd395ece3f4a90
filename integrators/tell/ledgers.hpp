// SPDX-License-Identifier: Apache-2.0
// What a step reports of its energy and momentum, part by part, and of what its contacts and joints did
// (MJ-9), (MJ-13), (IMP-6), (MJT-16).
#pragma once

#include "integrators/pose/trial.hpp"
#include "integrators/step_report.hpp"
#include "integrators/tell/joint_work.hpp"

namespace aussois {

/// What acted over a step and how it moved, rows of the problem.
struct StepBalance {
  VecX r{};                // impulses of the problem's blocks, of all stages [N s, N m s]
  VecX by_contacts{};      // momentum that contacts and gap functions gave [N s, N m s]; empty: none
  VecX by_joints{};        // likewise joints and what acts on their axes; empty: none
  VecX v_path{}, v_end{};  // constant on the path; at its end, after any projection
};
/// What impulses or forces in the rows of the problem give to all bodies together, about the world's origin
/// (MJ-13).
Momentum momentum_given(const StepSetting& setting, const State& state, const VecX& impulse);

/// Adds to the work of a contact law in a report that has one entry for each of setting.laws.
void add_work(const StepSetting& setting, const ContactLaw& law, double work, StepReport& report);

/// From `state` to `next`. Fills energy and momentum, the work of each contact and gap function, impulse_gain
/// and energy_rises of a report that has its contacts and gap functions already.
void tell_ledgers(const StepSetting& setting, const State& state, const State& next, const ImpulseStep& step,
                  const StepBalance& balance, StepReport& report);

/// What acted at the joints (MJT-12), (MJT-16) in a step of length `h`: impulses `r` of the problem's blocks,
/// `lambda` of the columns [N s, N m s], and `held` that projected to the end `next`.
std::vector<StepJoint> step_joints(const StepSetting& setting, const ImpulseStep& step, const Move& move,
                                   double h, const VecX& r, const VecX& lambda, const ProjectedState& held,
                                   const State& next);

}  // namespace aussois
