// SPDX-License-Identifier: Apache-2.0
// Attempts until one may be accepted: larger estimates, then shorter steps (CA-7), (CA-8).
#pragma once

#include <functional>

#include "integrators/tell/tell.hpp"

namespace aussois {

/// What a scheme gives: velocities that the state would end with if it touched nothing, and where it would
/// go with the contacts that it finds ahead.
struct StepMethod {
  std::function<VecX(const State&, double h)> estimate{};
  std::function<Trial(const State&, const Estimate&, double h)> attempt{};
};

/// Advances by at most min(options.h, h_limit); shorter if the advancement needs it. The state is unchanged
/// unless the report says moved(). Throws for what does not fit (check_fits), not for trouble of numbers.
StepReport advance_step(const StepSetting& setting, State& state, double h_limit, const StepMethod& method);

}  // namespace aussois
