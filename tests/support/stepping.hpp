// SPDX-License-Identifier: Apache-2.0
// A run of a scheme by its name, as most tests of mechanisms want it.
#pragma once

#include <functional>

#include <gtest/gtest.h>

#include "examples/scenes/cases.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

/// Steps from the scene's state to t_end; `look` sees the state after each.
inline State run_scene(const CaseScene& scene, const std::string& name, const SchemeOptions& options,
                       double t_end, const std::function<void(const State&, const StepReport&)>& look = {}) {
  const Scheme scheme = make_scheme(name, scene.model, options);
  State state = scene.state;
  while (state.t < t_end * (1 - 1e-12)) {
    const StepReport report = scheme.step(state, t_end - state.t);
    EXPECT_TRUE(report.ok()) << name << ": " << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
    if (look) look(state, report);
  }
  return state;
}

/// For mechanisms without shapes, solved to rounding.
inline SchemeOptions mechanism_options(double h) {
  return {.h = h,
          .theta = 0.5,
          .normal = {.law = NormalLaw::moreau},
          .solver = {.tolerance = 1e-12},
          .advancement = {.certify = false},
          .spectral_radius = 1};
}

}  // namespace aussois
