// SPDX-License-Identifier: Apache-2.0
// A run that gains energy little by little is reported, one that keeps it or is given it is not (LED-4).
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/springs.hpp"
#include "integrators/pose/joint_rows.hpp"
#include "integrators/run.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/one_axis.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

/// Of a run of `steps`, none of which rises by itself.
EnergyGain gain_of(const Model& model, State state, const Scheme& scheme, int steps) {
  EnergyGain out = energy_gain(model, state);
  for (int k = 0; k < steps; ++k) {
    const StepReport report = scheme.step(state, kInf);
    EXPECT_TRUE(report.ok()) << report.reason;
    EXPECT_FALSE(report.energy_rises) << "step " << k;
    add_step(model, state, report, out);
  }
  return out;
}

struct Top {
  Model model{};
  State state{};
  Top() {
    model.gravity.setZero();
    add(model, RigidBody{.name = "top", .mass = 1, .inertia = Vec3(1, 2, 3).asDiagonal()});
    state = rest_state(model);
    twist(state, 0).tail<3>() << 0.3, 2, 0.4;
  }
};

// A contact gives a hundred-thousandth in each step, which is not reported. It is from a thousandth over the
// run on.
TEST(EnergyGain, TellsWhatAContactGivesInStepsTooSmallToBeTold) {
  const Top top;
  State state = top.state;
  state.v << 1, 0, 0, 0, 0, 0;
  EnergyGain gain = energy_gain(top.model, state);
  for (int k = 1; k <= 1000; ++k) {
    state.v[0] = std::sqrt(1 + 1e-5 * k);
    StepReport report;
    report.h = 1e-3;
    report.energy.contact_work = report.energy.kinetic_change = 0.5e-5;
    report.law_work = {0.5e-5};
    add_step(top.model, state, report, gain);
    if (k <= 95 || k >= 105) {
      EXPECT_EQ(energy_rises(gain), k > 100) << k;
    }
  }
  EXPECT_NEAR(gain.largest, 0.5e-2, 1e-12);
  EXPECT_TRUE(energy_rises(gain));
}

TEST(EnergyGain, IsNotHiddenByWhatWasLostBefore) {
  const Top top;
  State state = top.state;
  EnergyGain gain = energy_gain(top.model, state);
  for (const double speed : {2.0, 1.0, 1.01}) {
    state.v << speed, 0, 0, 0, 0, 0;
    add_step(top.model, state, {}, gain);
  }
  EXPECT_NEAR(gain.largest, (1.01 * 1.01 - 1) / 2, 1e-12);
  EXPECT_TRUE(energy_rises(gain));
}

// A block leaves the plate at a third of the speed that its weight takes from it in the step (LED-5).
TEST(EnergyGain, IsThatOfAContactPressedShutWhileItOpens) {
  const double h = 1e-3, speed = 9.81 * h / 3;
  for (const double theta : {0.5, 0.75, 1.0}) {
    SCOPED_TRACE(theta);
    Scene scene = block_on_plate(0, 0, 0);
    twist(scene.state, scene.block)[2] = speed;
    EnergyGain gain = energy_gain(scene.model, scene.state);
    const double first = gain.stored, mass = scene.model.bodies[scene.block].mass;
    const StepReport report = MoreauJean(scene.model, {.h = h}, {.theta = theta}).step(scene.state, kInf);
    ASSERT_TRUE(report.ok()) << report.reason;
    add_step(scene.model, scene.state, report, gain);
    const double impulse = mass * (9.81 * h - speed);
    EXPECT_NEAR(gain.stored - first, (1 - theta) * impulse * speed - (theta - 0.5) * mass * speed * speed,
                1e-9 * mass * speed * speed);
    EXPECT_EQ(gain.largest > 0, theta < 1);
  }
}

TEST(EnergyGain, IsNoneWhereEnergyIsKept) {
  const Top top;
  const Scheme midpoint = make_scheme("passive_midpoint", top.model, {.step = {.h = 5e-2}});
  EXPECT_LT(gain_of(top.model, top.state, midpoint, 1000).largest, 1e-12);

  Scene ball = block_on_plate(0, 1, 0, 0.05);  // a block that bounces flat
  const Scheme bouncing = make_scheme("moreau_jean", ball.model,
                                      {.step = {.h = 1e-3}, .moreau_jean = {.law = NormalLaw::moreau}});
  const EnergyGain bounced = gain_of(ball.model, ball.state, bouncing, 1000);
  EXPECT_LT(bounced.largest, 1e-6 * bounced.kinetic);

  Scene rest = block_on_plate(0.5, 0, 0.2);
  const Scheme resting = make_scheme("moreau_jean", rest.model, {.step = {.h = 1e-3}});
  const EnergyGain rested = gain_of(rest.model, rest.state, resting, 1000);
  EXPECT_FALSE(energy_rises(rested)) << rested.largest << " of " << rested.kinetic;
}

// A ride on a plate that speeds up, motors of all kinds, a spring that lets go: much energy, none of it
// gained.
TEST(EnergyGain, IsNoneWhereEnergyIsGiven) {
  Scene ride = block_on_plate(0.5, 0, 0);
  Trajectory path;
  for (int i = 0; i <= 100; ++i) {
    path.t.push_back(0.01 * i);
    path.pose.push_back(translation(0.5 * path.t.back() * path.t.back(), 0, 0));
  }
  ride.model.bodies[ride.ground].motion = PrescribedMotion{path};
  ride.state = rest_state(ride.model);
  pose(ride.state, ride.block).p.z() = kSide / 2 + 2 * kRadius;
  const EnergyGain rode =
      gain_of(ride.model, ride.state, make_scheme("moreau_jean", ride.model, {.step = {.h = 5e-3}}), 180);
  EXPECT_GT(rode.kinetic, 0.3);
  EXPECT_FALSE(energy_rises(rode)) << rode.largest;

  const Motor motors[] = {{.kind = MotorKind::effort, .target = [](double) { return 3; }},
                          {.kind = MotorKind::speed, .target = [](double t) { return t; }},
                          {.kind = MotorKind::position, .target = [](double t) { return t * t; }}};
  for (const Motor& motor : motors) {
    OneAxis wheel(JointKind::revolute);
    wheel.axis().motor = motor;
    const EnergyGain driven = gain_of(wheel.model, wheel.state,
                                      make_scheme("moreau_jean", wheel.model, {.step = {.h = 1e-3}}), 1000);
    EXPECT_GT(driven.kinetic, 0.05);
    EXPECT_FALSE(energy_rises(driven)) << driven.largest;
  }

  OneAxis sprung(JointKind::revolute);
  sprung.axis() = {.stiffness = 50, .damping = 0.5, .rest = 0.5};
  const EnergyGain swung = gain_of(sprung.model, sprung.state,
                                   make_scheme("moreau_jean", sprung.model, {.step = {.h = 1e-3}}), 1000);
  EXPECT_GT(swung.kinetic, 1);
  EXPECT_FALSE(energy_rises(swung)) << swung.largest;

  Top pulled;
  add(pulled.model, spring(0, Vec3(20, 30, 40)));
  pose(pulled.state, 0).p = Vec3(1, 1, 1);
  pulled.state.v.setZero();
  const EnergyGain drawn = gain_of(pulled.model, pulled.state,
                                   make_scheme("moreau_jean", pulled.model, {.step = {.h = 1e-3}}), 1000);
  EXPECT_GT(drawn.kinetic, 10);
  EXPECT_FALSE(energy_rises(drawn)) << drawn.largest;
}

}  // namespace
}  // namespace aussois
