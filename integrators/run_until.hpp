// SPDX-License-Identifier: Apache-2.0
// A run, for those who ask nothing of it between steps but what `look` hears.
#pragma once

#include <cmath>

#include "integrators/step_report.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Steps until State::t is `t_end` [s], or a report is not ok: a step that is refused is refused again, so a
/// loop that waits for the time alone may never end. `look(report)` hears of every step. Returns the report
/// of the last; if there is nothing to do, one of a step of length 0.
template <class AnyScheme, class Look>
[[nodiscard]] StepReport run_until(const AnyScheme& scheme, State& state, double t_end, const Look& look) {
  constexpr double kSameTime = 1e-12;  // relative; what the sum of many steps leaves of a run is no step
  StepReport report;
  report.t = state.t;
  while (report.ok() && t_end - state.t > kSameTime * std::abs(t_end)) {
    report = scheme.step(state, t_end - state.t);
    look(report);
  }
  return report;
}
template <class AnyScheme>
[[nodiscard]] StepReport run_until(const AnyScheme& scheme, State& state, double t_end) {
  return run_until(scheme, state, t_end, [](const StepReport&) {});
}

}  // namespace aussois
