// SPDX-License-Identifier: Apache-2.0
// A cube of 10 cm on a plate, and its runs.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/block_on_plate.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {

/// All but the Newton loop of an implicit step went well: contacts come and go between its iterates.
inline bool is_loop_left_open(const StepReport& report) {
  return report.status == StepStatus::not_solved && is_solved(report.solve.status) &&
         report.newton_change > NewtonOptions{}.tolerance;
}

inline StepReport run(const MoreauJean& scheme, State& state, double t_end) {
  StepReport report;
  while (state.t < t_end - 1e-12) {
    report = scheme.step(state, t_end - state.t);
    EXPECT_TRUE(report.ok()) << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
  }
  return report;
}

}  // namespace aussois
