// SPDX-License-Identifier: Apache-2.0
// What happened in a step, and what the next one is to know of it.
#pragma once

#include "integrators/prove/judge.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

/// Of a trial and what was said to it: what was found, solved and proven; of one that is taken also contacts,
/// joints and ledgers (MJ-9), (MJ-13), (MJT-16).
StepReport tell(const StepSetting& setting, const State& state, const Trial& trial,
                const Judgement& judgement);

/// The state that a trial leads to, with all that the next step is to know of contacts and impulses.
State next_state(const StepSetting& setting, const Trial& trial, const Judgement& judgement);

/// Whether a state follows from it: nothing speaks against it but a solver that did not get there.
bool may_be_taken(const Judgement& judgement);

}  // namespace aussois
