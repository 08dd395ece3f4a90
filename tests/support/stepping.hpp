// SPDX-License-Identifier: Apache-2.0
// Runs of a scheme, as most tests of mechanisms want them.
#pragma once

#include <functional>

#include <gtest/gtest.h>

#include "examples/scenes/cases.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

/// Steps of any scheme up to t_end; `look` hears of each, when `state` is already the one after it.
template <class AnyScheme>
void advance(const AnyScheme& scheme, State& state, double t_end,
             const std::function<void(const StepReport&)>& look = {}) {
  while (state.t < t_end - 1e-12) {
    const StepReport report = scheme.step(state, t_end - state.t);
    ASSERT_TRUE(report.ok()) << report.reason << " at t = " << state.t;
    if (look) look(report);
  }
}

/// The same for a scene and the name of a scheme; `look` sees the state after each step.
inline State run_scene(const CaseScene& scene, const std::string& name, const SchemeOptions& options,
                       double t_end, const std::function<void(const State&, const StepReport&)>& look = {}) {
  SCOPED_TRACE(name);
  State state = scene.state;
  advance(make_scheme(name, scene.model, options), state, t_end, [&](const StepReport& report) {
    if (look) look(state, report);
  });
  return state;
}

/// For mechanisms without shapes, solved to rounding.
inline SchemeOptions mechanism_options(double h) {
  return {.step = {.h = h, .solver = {.tolerance = 1e-12}, .advancement = {.certify = false}},
          .moreau_jean = {.theta = 0.5, .law = NormalLaw::moreau},
          .generalised_alpha = {.spectral_radius = 1}};
}

}  // namespace aussois
