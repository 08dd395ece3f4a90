// SPDX-License-Identifier: Apache-2.0
// The loop that all sweeping methods share: step, ask the judge when it is due, keep the best iterate, stop
// (FIX-1). With SolverOptions::anderson it also tries what the last steps together point to (AA-1). Private
// to nsgs.
#pragma once

#include <functional>

#include "nsgs/method.hpp"

namespace aussois {

/// Moves r, whose velocities W has at hand, by one step of a method. Returns the size of the change.
using Step = std::function<double(VecX& r)>;

Iterate fixed_point(Delassus& W, const Iterate& start, Method by, const SolverOptions& options,
                    SolveReport& report, const Step& step);

}  // namespace aussois
