// SPDX-License-Identifier: Apache-2.0
// Tries a step until an attempt may be accepted: with larger estimates, then with shorter steps (CA-7),
// (CA-8).
#pragma once

#include <functional>

#include "integrators/tell/tell.hpp"

namespace aussois {

/// What a scheme provides: the velocities that the state would end with if it touched nothing, and where it
/// would go with the contacts found ahead.
struct StepMethod {
  std::function<VecX(const State&, double h)> estimate{};
  std::function<Trial(const State&, const Estimate&, double h)> attempt{};
};

/// Advances by at most min(options.h, h_limit); less if the advancement needs it. The state is unchanged
/// unless the report says moved(). Throws for arguments that do not fit (check_fits), not for numerical
/// trouble.
StepReport advance_step(const StepSetting& setting, State& state, double h_limit, const StepMethod& method);

}  // namespace aussois
