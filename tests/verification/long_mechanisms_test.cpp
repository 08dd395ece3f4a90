// SPDX-License-Identifier: Apache-2.0
// The benchmark list at its full length (doc/theory/mechanism_benchmarks.md).
#include <cmath>

#include <gtest/gtest.h>

#include "integrators/event_driven.hpp"
#include "tests/support/one_angle.hpp"

namespace aussois {
namespace {

// C7. 81 rods, 605 equations for the 485 motions that are not free; four of the ten turns of the whole 20 s,
// which take two and a half times as long.
TEST(FourBars, OfFortyWindowsTurnForEightSeconds) {
  const FourBarErrors run = four_bar_errors(40, "moreau_jean", 7e-4, 8);
  EXPECT_LT(run.energy, 1e-6);
  EXPECT_LT(run.angle, 1e-3);
  EXPECT_LT(run.drift, 1e-11);
}

// C10. A hundred turns on mean joints (MJT-14): what is lost is the rounding of 20944 steps.
TEST(SpinningChain, KeepsItsEnergyForAHundredTurnsOnMeanJoints) {
  const CaseScene s = spinning_chain(6, 3, JointKind::spherical);
  SchemeOptions options = mechanism_options(1e-2);
  options.update = GroupUpdate::cayley;
  options.mean_joints = true;
  const double before = energy(s.model, s.state).total();
  const Momentum start = momentum(s.model, s.state);
  double worst = 0, drift = 0;
  const State end = run_scene(
      s, "passive_midpoint", options, 100 * 2 * kPi / 3, [&](const State& state, const StepReport& report) {
        worst = std::max(worst, std::abs(energy(s.model, state).total() / before - 1));
        drift = std::max(drift, report.joint_error.translation);
      });
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT((momentum(s.model, end).angular - start.angular).norm() / start.angular.norm(), 1e-12);
  EXPECT_LT(drift, 1e-14);
}

// The same at the tightest tolerances of the event-driven reference: what CVODE loses.
TEST(SpinningChain, KeepsItsEnergyForAHundredTurns) {
  const CaseScene s = spinning_chain(6, 3, JointKind::spherical);
  const EventDriven scheme(s.model, {.ode = {.relative = 1e-13, .absolute = 1e-15},
                                     .step = {.h = 10, .solver = {.tolerance = 1e-13}}});
  const double t_end = 100 * 2 * kPi / 3, before = energy(s.model, s.state).total();
  const Vec3 start = momentum(s.model, s.state).angular;
  State state = s.state;
  while (state.t < t_end * (1 - 1e-12)) ASSERT_TRUE(scheme.step(state, t_end - state.t).ok());
  EXPECT_LT(std::abs(energy(s.model, state).total() / before - 1), 2e-9);
  EXPECT_LT((momentum(s.model, state).angular - start).norm() / start.norm(), 1e-9);
  EXPECT_LT((pose(state, 0).p - pose(s.state, 0).p).norm(), 3e-7);
}

}  // namespace
}  // namespace aussois
