// SPDX-License-Identifier: Apache-2.0
// A scheme that the kernel does not know: backward Euler with contacts at the start. All that a scheme has to
// say is how it would go on without contacts, and where it wants to go with them.
#pragma once

#include <memory>

#include "integrators/schemes/advance_step.hpp"

namespace aussois {

class ToyScheme {
 public:
  ToyScheme(const Model& model, const StepOptions& options)
      : setting_(step_setting(model, options, NormalLaw::gap_over_step)) {}

  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const {
    const auto free = [&](const State& start, double h) {
      return std::make_shared<const FreeMotion>(free_motion(setting_.model, start, setting_.dofs, h, 1));
    };
    const auto estimate = [&](const State& start, double h) {
      return estimate_without_contacts(setting_, start, *free(start, h), h, 1);
    };
    const auto attempt = [&](const State& start, const Estimate& ahead, double h) {
      Trial trial{.found = find_ahead(setting_, start, ahead, h)};
      trial.impulses = solve_step(setting_, start, trial.found, free(start, h), 1);
      trial.move.v_path = trial.move.v_end = trial.impulses.solved.solution.v;
      return trial;
    };
    return advance_step(setting_, state, h_limit, {estimate, attempt});
  }

 private:
  StepSetting setting_;
};

}  // namespace aussois
