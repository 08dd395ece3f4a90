// SPDX-License-Identifier: Apache-2.0
// Joints on the mean of both ends of a step (MJT-14), (MJT-15): nothing drifts, works or turns by them.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/tumbling.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/mechanism.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

PassiveMidpoint on_mean(const Model& model, double h) {
  return PassiveMidpoint(model, {.h = h, .solver = {.tolerance = 1e-14}, .update = GroupUpdate::cayley},
                         {.mean_joints = true});
}

// A hundred large steps, 0.05 rad each. A screw, whose angle is no bilinear function, only holds.
TEST(MeanJoints, NeitherDriftNorWorkNorTurnTheWhole) {
  for (const JointKind kind : {JointKind::fixed, JointKind::revolute, JointKind::prismatic,
                               JointKind::cylindrical, JointKind::spherical, JointKind::universal,
                               JointKind::planar, JointKind::screw, JointKind::distance}) {
    SCOPED_TRACE(to_string(kind));
    Tumbling s(kind);
    const double E = energy(s.model, s.state).total();
    const Momentum before = momentum(s.model, s.state);
    double pushed = 0;
    advance(on_mean(s.model, 1e-2), s.state, 1, [&](const StepReport& report) {
      EXPECT_LT(report.joint_error.translation + report.joint_error.rotation, 1e-13);
      EXPECT_LT(std::abs(report.energy.residual()), 1e-13);
      pushed = std::max(pushed, report.joints[0].force.norm());
    });
    EXPECT_GT(pushed, 0.1);
    const Momentum after = momentum(s.model, s.state);
    EXPECT_LT((after.linear - before.linear).norm(), 1e-13);
    EXPECT_LT((after.angular - before.angular).norm(), kind == JointKind::screw ? 1e-3 : 2e-12);
    EXPECT_LT(std::abs(energy(s.model, s.state).total() - E), kind == JointKind::screw ? 1e-3 : 2e-12);
  }
}

// Two rods on hinges, hanging from a wall, level at the start.
struct Chain {
  Model model{};
  State state{};
  Chain() {
    for (int i = 0; i < 2; ++i)
      add(model,
          RigidBody{.name = "rod", .mass = 1, .inertia = Vec3(1.0 / 1200, 1.0 / 12, 1.0 / 12).asDiagonal()});
    state = rest_state(model);
    for (int i = 0; i < 2; ++i) {
      pose(state, BodyId::at(i)).p.x() = 0.5 + i;
      add(model, joint_at(JointKind::revolute, "hinge", BodyId::at(i), BodyId::at(i - 1), state.g,
                          translation(i, 0, 0) * rotation(Vec3::UnitX(), kPi / 2)));
    }
  }
};

// Through long swings: what a chain of hinges loses of its energy is rounding.
TEST(MeanJoints, KeepTheEnergyOfADoublePendulum) {
  Chain s;
  const double E = energy(s.model, s.state).total();
  double worst = 0, fastest = 0;
  advance(on_mean(s.model, 4e-3), s.state, 3, [&](const StepReport&) {
    worst = std::max(worst, std::abs(energy(s.model, s.state).total() - E));
    fastest = std::max(fastest, energy(s.model, s.state).kinetic);
  });
  EXPECT_GT(fastest, 10);
  EXPECT_LT(worst, 1e-11);  // J; projected, with the rows of a predicted middle: 5e-4
}

// Under torques that are held over each step, a law stated at the midpoint stays so while the joints settle.
TEST(MeanJoints, LetStopsGiveNoEnergy) {
  Chain s;
  for (JointId j = 0; j < 2; ++j)
    s.model.joints[j].axis[0].lower = -0.05, s.model.joints[j].axis[0].upper = 0.05;
  s.model.forces.push_back(
      {.name = "noise", .add_to = [](const Model&, const State& now, double, GeneralisedForce& force) {
         Random random(std::uint64_t(std::llround(1e6 * now.t)));
         for (BodyId b = 0; b < 2; ++b) body_part(force.f, b)[4] += random.uniform(-100, 100);
       }});
  int made_passive = 0;
  advance(on_mean(s.model, 1e-3), s.state, 1, [&](const StepReport& report) {
    const double given = report.energy.law_work + report.energy.gravity_work;
    const double stored = report.energy.kinetic_change;
    EXPECT_LT(stored - given, 1e-12);  // J, of the 15 mJ that a torque may give in a step
    made_passive += report.contacts_made_passive;
  });
  EXPECT_GT(made_passive, 10);
}

// What is not bilinear is held at the end by Newton: a gear, and a motor that prescribes where its wheel is.
TEST(MeanJoints, HoldGearsAndMotorsAtTheEnd) {
  const auto axis = rotation(Vec3::UnitX(), kPi / 2);
  Model model;
  for (const double J : {0.5, 3.0})
    add(model, RigidBody{.name = "wheel", .mass = 1, .inertia = J * Mat3::Identity()});
  State state = rest_state(model);
  pose(state, 1).p.x() = 1;
  add(model, joint_at(JointKind::revolute, "first", 0, kWorld, state.g, axis));
  add(model, joint_at(JointKind::revolute, "second", 1, kWorld, state.g, translation(1, 0, 0) * axis));
  add(model, Coupling{.name = "gears", .joint_1 = 0, .joint_2 = 1, .ratio = -2.5});
  const auto wanted = [](double t) { return 1 - std::cos(5 * t); };
  model.joints[0].axis[0].motor = {.kind = MotorKind::position, .target = wanted};
  advance(on_mean(model, 1e-2), state, 2, [&](const StepReport& report) {
    EXPECT_NEAR(joint_coordinate(model, state, 0), wanted(state.t), 1e-12);
    EXPECT_NEAR(joint_coordinate(model, state, 1), -wanted(state.t) / 2.5, 1e-12);
    EXPECT_LT(std::abs(report.energy.residual()), 1e-11);
  });
}

TEST(MeanJoints, NeedCayleysMap) {
  const Tumbling s(JointKind::revolute);
  const std::string refusal =
      message_of([&] { PassiveMidpoint(s.model, {.h = 1e-3}, {.mean_joints = true}); });
  EXPECT_NE(refusal.find("mean_joints"), std::string::npos);
  EXPECT_NE(refusal.find("cayley, not exponential"), std::string::npos);
}

}  // namespace
}  // namespace aussois
