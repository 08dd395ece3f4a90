// SPDX-License-Identifier: Apache-2.0
// Turns a judged trial into the report of the step and the state that the next step starts from.
#pragma once

#include "integrators/prove/judge.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepResult {
  StepReport report{};
  State next{};  // where a trial that may be taken leads, with all that the next step needs of contacts and
                 // impulses
};
/// The result of a trial and its judgement. The report holds what was found, solved and proven; of a trial
/// that may be taken also contacts, joints and ledgers (MJ-9), (MJ-13), (MJT-16).
StepResult tell(const StepSetting& setting, const State& state, const Trial& trial, Judgement judgement);

/// Whether the trial may be taken: there is no objection, except perhaps that the solver did not converge.
bool may_be_taken(const Judgement& judgement);

}  // namespace aussois
