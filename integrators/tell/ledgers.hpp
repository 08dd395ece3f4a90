// SPDX-License-Identifier: Apache-2.0
// Reports the energy and momentum of a step, part by part, and what its contacts and joints did (MJ-9),
// (MJ-13), (IMP-6), (MJT-16).
#pragma once

#include "integrators/pose/trial.hpp"
#include "integrators/step_report.hpp"
#include "integrators/tell/joint_work.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {

/// What acted over a step and how the step moved, in rows of the problem.
struct StepBalance {
  VecX r{};                // impulses of the problem's blocks, of all stages [N s, N m s]
  VecX by_contacts{};      // momentum from contacts and gap functions [N s, N m s]; empty: none
  VecX by_joints{};        // likewise from joints and what acts on their axes; empty: none
  VecX v_path{}, v_end{};  // constant on the path; at its end, after any projection
};
/// The momentum that impulses or forces in the rows of the problem give to all bodies together, about the
/// world's origin (MJ-13).
Momentum momentum_given(const StepSetting& setting, const State& state, const VecX& impulse);
/// The same where trees carry bodies: what bases pass on to fixed bodies or the world does not count
/// (TREE-7). `inverse` is that of the masses.
Momentum momentum_given(const StepSetting& setting, const State& state, const VecX& impulse,
                        const std::optional<MassInverse>& inverse);

/// Adds to the work of a contact law in a report that has one entry for each of setting.laws.
void add_law_work(const StepSetting& setting, const ContactLaw& law, double work, StepReport& report);

/// For a step from `state` to `next`, fills in energy and momentum, the work of each contact and gap
/// function, impulse_gain and energy_rises. The report must have its contacts and gap functions already.
void tell_ledgers(const StepSetting& setting, const State& state, const State& next, const ImpulseStep& step,
                  const StepBalance& balance, StepReport& report);

/// What acted at the joints (MJT-12), (MJT-16) in a step of length `h`. `r` are the impulses of the problem's
/// blocks, `lambda` those of the columns [N s, N m s]; `held` is the projection that led to the end `next`.
Table<JointId, StepJoint> step_joints(const StepSetting& setting, const ImpulseStep& step, const Move& move,
                                      double h, const VecX& r, const VecX& lambda, const ProjectedState& held,
                                      const State& next);

}  // namespace aussois
