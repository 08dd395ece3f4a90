// SPDX-License-Identifier: Apache-2.0
// A cube of 10 cm on a plate: the small scene of many tests.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/moreau_jean.hpp"

namespace aussois {

inline constexpr double kSide = 0.1, kRadius = 1e-3, kGravity = 9.81, kDensity = 1000;

struct Scene {
  Model model{};
  int ground = -1, block = -1;
  State state{};
};

// A block at rest on a plate inclined by `slope` about y; gravity is tilted, not the plate.
inline Scene block_on_plate(double mu, double restitution, double slope, double height = 0) {
  Scene s;
  s.model.gravity = kGravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  s.model.contact_law = {.mu = mu, .restitution = restitution};
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const int plate = add(s.model, prepare(dilate(make_plate(6, 6), kRadius)));
  const int cube = add(s.model, prepare(dilate(box, kRadius)));
  s.ground = add(s.model, fixed_body("ground", plate));
  s.block = add(s.model, solid_body("block", cube, mass_properties(box, kDensity)));
  s.state = rest_state(s.model);
  pose(s.state, s.block).p.z() = kSide / 2 + 2 * kRadius + height;
  return s;
}

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
