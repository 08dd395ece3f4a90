// SPDX-License-Identifier: Apache-2.0
// Turns a judged trial into the report of the step and the state that the next step starts from.
#pragma once

#include "integrators/prove/judge.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

/// The report of a trial and its judgement: what was found, solved and proven; for a trial that is taken also
/// contacts, joints and ledgers (MJ-9), (MJ-13), (MJT-16).
StepReport tell(const StepSetting& setting, const State& state, const Trial& trial,
                const Judgement& judgement);

/// The state that a trial leads to, with all that the next step needs of contacts and impulses.
State next_state(const StepSetting& setting, const Trial& trial, const Judgement& judgement);

/// Whether the trial may be taken: there is no objection, except perhaps that the solver did not converge.
bool may_be_taken(const Judgement& judgement);

}  // namespace aussois
