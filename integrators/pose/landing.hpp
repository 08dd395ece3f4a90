// SPDX-License-Identifier: Apache-2.0
// How contacts that close in a step end closed where the path lags behind the velocities (MJ-17).
#pragma once

#include "integrators/pose/impulse_step.hpp"

namespace aussois {

/// What lands - was closing on the path, faster than a closed contact does, and would end overlapped - ends
/// closed, and is stopped if it still closes then; nothing else gets closer than closed. Whether a row lands
/// is a matter of velocities, which are unique where shares of a load are not. `v_path`: rows of the problem.
/// Returns the velocities of that path; `step` gets the impulses.
VecX landing_path(const StepSetting& setting, const State& start, const FoundContacts& found,
                  const VecX& v_path, ImpulseStep& step);

}  // namespace aussois
