// SPDX-License-Identifier: Apache-2.0
// doc/theory/mechanical_joints.md: mechanisms against what is known of them by other means.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/tumbling.hpp"
#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/gear_pair.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/one_axis.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kG = 9.81;

RigidBody rod(double mass = 1, double length = 1) {  // along x
  const double J = mass * length * length / 12;
  return {.name = "rod", .mass = mass, .inertia = Vec3(J / 100, J, J).asDiagonal()};
}

// A chain of rods along x, hinged about y to the world and to each other.
struct Chain {
  Model model{};
  State state{};
  explicit Chain(int rods) {
    for (int i = 0; i < rods; ++i) add(model, rod());
    state = rest_state(model);
    for (int i = 0; i < rods; ++i) {
      state.g[BodyId::at(i)].p = Vec3(0.5 + i, 0, 0);
      add(model, joint_at(JointKind::revolute, "hinge", BodyId::at(i), BodyId::at(i - 1), state.g,
                          translation(i, 0, 0) * kAboutY));
    }
  }
};

double order(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

struct PendulumErrors {
  double energy = 0, drift = 0, ledger = 0;
};
PendulumErrors swing(int rods, double h, double theta, const JointOptions& joints) {
  Chain c(rods);
  const MoreauJean scheme(c.model, {.h = h, .joints = joints}, {.theta = theta});
  const double E = energy(c.model, c.state).total();
  PendulumErrors out;
  advance(scheme, c.state, 1, [&](const StepReport& report) {
    out.energy = std::max(out.energy, std::abs(energy(c.model, c.state).total() - E));
    out.drift = std::max({out.drift, report.joint_error.translation, report.joint_error.rotation});
    out.ledger = std::max(out.ledger, std::abs(report.energy.residual()));
  });
  return out;
}

TEST(Pendulum, EnergyDriftsWithOrderTwoAtThetaOneHalfAndOneAtThetaOne) {
  for (const bool project : {true, false})
    for (const double theta : {0.5, 1.0}) {
      const JointOptions joints{.project = project};
      const PendulumErrors coarse = swing(1, 7e-3, theta, joints), fine = swing(1, 2e-3, theta, joints);
      EXPECT_NEAR(order(coarse.energy, fine.energy, 3.5), theta < 1 ? 2 : 1, 0.3);
      EXPECT_LT(fine.ledger, 1e-13);
      EXPECT_LT(fine.energy, theta < 1 ? 2e-4 : 0.5);  // of 4.9 J exchanged
    }
}

TEST(Pendulum, DriftIsOfThirdOrderAndGoneWhenProjected) {
  for (const double theta : {0.5, 1.0}) {
    const JointOptions bias{.project = false};
    EXPECT_NEAR(order(swing(2, 7e-3, theta, bias).drift, swing(2, 2e-3, theta, bias).drift, 3.5), 3, 0.25);
    EXPECT_LT(swing(2, 7e-3, theta, {}).drift, 1e-12);
  }
  const JointOptions nothing{.project = false, .stabilisation = 0};
  EXPECT_NEAR(order(swing(2, 7e-3, 0.5, nothing).drift, swing(2, 2e-3, 0.5, nothing).drift, 3.5), 2, 0.25);
}

TEST(Pendulum, HangsOnItsJointWithItsWeight) {
  Model model;
  add(model, rod(2));
  State state = rest_state(model);
  state.g[0].p.x() = 0.5;
  add(model, joint_at(JointKind::fixed, "clamp", 0, kWorld, state.g, SE3{}));
  const StepReport report = MoreauJean(model, {}, {.theta = 1}).step(state);
  ASSERT_TRUE(report.ok());
  EXPECT_LT((report.joints[0].force - Vec3(0, 0, 2 * kG)).norm(), 1e-9);
  // about the clamp the weight pulls the rod down with 2 g 0.5 about +y
  EXPECT_LT((report.joints[0].torque - Vec3(0, -kG, 0)).norm(), 1e-9);
  EXPECT_LT(twist(state, 0).norm(), 1e-12);
}

TEST(Pendulum, ForgetsAnInconsistentStart) {
  for (const double theta : {0.5, 1.0}) {
    Chain c(1);
    c.model.gravity = Vec3::Zero();
    c.state.v[0] = 0.1;  // along the rod
    const MoreauJean scheme(c.model, {.h = 1e-3, .joints = {.project = false}}, {.theta = theta});
    advance(scheme, c.state, 0.1);
    EXPECT_LT(c.state.v.norm(), 1e-12);
  }
}

// N windows, all rods parallel: one equation for the angle from the vertical (IFToMM A02).
TEST(FourBar, MovesAsItsOneEquationSaysAlthoughItsJointsAreRedundant) {
  const auto error = [](double h) {
    Model model;
    for (int i = 0; i < 3; ++i) add(model, rod());
    State state = rest_state(model);
    const SE3 upright = rotation(Vec3::UnitY(), -kPi / 2);  // x of the rod points up
    state.g[0] = {upright.R, Vec3(0, 0, 0.5)};
    state.g[1] = {upright.R, Vec3(1, 0, 0.5)};
    state.g[2].p = Vec3(0.5, 0, 1);
    const auto hinge = [&](BodyId a, BodyId b, double x, double z) {
      add(model, joint_at(JointKind::revolute, "hinge", a, b, state.g, translation(x, 0, z) * kAboutY));
    };
    hinge(0, kWorld, 0, 0), hinge(1, kWorld, 1, 0), hinge(0, 2, 0, 1), hinge(1, 2, 1, 1);  // 20 rows for 17
    for (const BodyId crank : {BodyId(0), BodyId(1)}) twist(state, crank) << 0.5, 0, 0, 0, 1, 0;
    twist(state, 2) << 1, 0, 0, 0, 0, 0;
    const double E = energy(model, state).total();
    const MoreauJean scheme(model, {.h = h}, {.theta = 0.5});
    advance(scheme, state, 0.4);
    EXPECT_LT(std::abs(energy(model, state).total() - E), 10 * h * h);
    EXPECT_LT(joint_error(model, state).translation, 1e-12);
    double th = 0, w = 1;  // midpoint rule, ten thousand steps
    for (int i = 0; i < 10000; ++i) {
      const double dt = 4e-5, k = 2.0 / (5.0 / 3) * kG;
      const double th_mid = th + dt / 2 * w, w_mid = w + dt / 2 * k * std::sin(th);
      th += dt * w_mid, w += dt * k * std::sin(th_mid);
    }
    return std::abs(joint_coordinate(model, state, 0) - th);
  };
  const double coarse = error(7e-3), fine = error(2e-3);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(order(coarse, fine, 3.5), 2, 0.2);
}

// Six hinges in space where seven would be needed to be able to move at all: rank 29 of 30 (IFToMM A04).
TEST(Bricard, MovesAndKeepsItsEnergy) {
  const auto lost = [](double h) {
    Model model;
    model.gravity = Vec3(0, -kG, 0);
    const Vec3 corner[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
    const Vec3 axis[] = {Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX(),
                         Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX()};
    for (int i = 0; i < 5; ++i) add(model, rod());
    State state = rest_state(model);
    for (int i = 0; i < 5; ++i)
      state.g[BodyId::at(i)] = {Quat::FromTwoVectors(Vec3::UnitX(), corner[i + 1] - corner[i]),
                                (corner[i] + corner[i + 1]) / 2};
    for (int i = 0; i < 6; ++i)
      add(model, joint_at(JointKind::revolute, "hinge", BodyId::at(i < 5 ? i : -1), BodyId::at(i - 1),
                          state.g, {Quat::FromTwoVectors(Vec3::UnitZ(), axis[i]), corner[i]}));
    const double E = energy(model, state).total();
    EXPECT_NEAR(E, -3 * kG, 1e-12);
    double worst = 0;
    const MoreauJean scheme(model, {.h = h}, {.theta = 0.5});
    advance(scheme, state, 1, [&](const StepReport& report) {
      worst = std::max(worst, std::abs(energy(model, state).total() - E));
      EXPECT_LT(report.joint_error.translation, 1e-11);
    });
    EXPECT_GT(state.v.norm(), 1);  // it does move
    return worst;
  };
  const double coarse = lost(1e-2), fine = lost(3e-3);
  EXPECT_LT(fine, 1e-2);
  EXPECT_GT(order(coarse, fine, 10.0 / 3), 1.8);
}

TEST(Slider, BouncesBetweenItsStopsExactly) {
  for (const double theta : {0.5, 1.0}) {
    OneAxis s(JointKind::prismatic);
    s.axis() = {.lower = -0.1, .upper = 0.2, .restitution = 0.8};
    s.state.v[0] = 1;
    const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = theta});
    int impacts = 0;
    double before = s.speed();
    advance(scheme, s.state, 2, [&](const StepReport& report) {
      if (s.speed() * before < 0) {
        ++impacts;
        EXPECT_NEAR(std::abs(s.speed()), std::pow(0.8, impacts), 1e-12);
        EXPECT_NEAR(report.joints[0].effort[0] * report.h, 2 * (s.speed() - before), 1e-12);
      }
      before = s.speed();
      EXPECT_GT(s.q(),
                -0.1 - (1 - theta) * 1e-3);  // at theta = 1/2 the step of the impact moves on by h v / 2
      EXPECT_LT(s.q(), 0.2 + (1 - theta) * 1e-3);
    });
    EXPECT_GE(impacts, 4);
  }
}

TEST(Slider, WithPlasticStopsComesToRestOnThem) {
  OneAxis s(JointKind::prismatic);
  s.model.gravity = Vec3(kG, 0, 0);
  s.axis() = {.upper = 0.3};
  advance(MoreauJean(s.model, {.h = 7e-3}, {.theta = 1}), s.state, 1);
  EXPECT_NEAR(s.q(), 0.3, 1e-12);
  EXPECT_NEAR(s.speed(), 0, 1e-12);
}

TEST(Slider, StopsByDryFrictionAtTheExactTime) {
  for (const double theta : {0.5, 1.0}) {
    OneAxis s(JointKind::prismatic, 2);
    s.axis().friction = 4;  // 2 m/s^2
    s.state.v[0] = 1;
    const MoreauJean scheme(s.model, {.h = 1e-2}, {.theta = theta});
    advance(scheme, s.state, 0.49);
    EXPECT_NEAR(s.speed(), 0.02, 1e-12);
    advance(scheme, s.state, 0.5);
    EXPECT_NEAR(s.speed(), 0, 1e-12);
    EXPECT_NEAR(s.q(), 0.25, theta < 1 ? 1e-12 : 5.1e-3);
    advance(scheme, s.state, 1, [&](const StepReport& r) { EXPECT_LE(r.energy.joint_work, 1e-15); });
    EXPECT_NEAR(s.speed(), 0, 1e-12);
    s.model.gravity = Vec3(1.9, 0, 0);  // below the friction: stays
    advance(MoreauJean(s.model, {.h = 1e-2}, {.theta = theta}), s.state, 2);
    EXPECT_NEAR(s.speed(), 0, 1e-12);
  }
}

TEST(Wheel, OnASpringSwingsWithOrderTwoAndLosesEnergyToItsDamperOnly) {
  const auto error = [](double h) {
    OneAxis w(JointKind::revolute);
    w.axis() = {.stiffness = 50, .damping = 0.3, .rest = 2 * kPi};  // a full turn away
    advance(MoreauJean(w.model, {.h = h}, {.theta = 0.5}), w.state, 1);
    const double b = 0.3 / (2 * 0.5), f = std::sqrt(50 / 0.5 - b * b), t = 1;
    return w.q() - 2 * kPi * (1 - std::exp(-b * t) * (std::cos(f * t) + b / f * std::sin(f * t)));
  };
  EXPECT_LT(std::abs(error(1e-3)), 1e-3);
  EXPECT_NEAR(order(std::abs(error(7e-3)), std::abs(error(2e-3)), 3.5), 2, 0.2);
  OneAxis w(JointKind::revolute);
  w.axis() = {.stiffness = 50, .rest = 1};
  const double E = energy(w.model, w.state).total();
  EXPECT_NEAR(E, 25, 1e-12);
  advance(MoreauJean(w.model, {.h = 5e-3}, {.theta = 0.5}), w.state, 1);
  EXPECT_NEAR(energy(w.model, w.state).total(), E, 1e-12 * E);  // a linear spring on a straight path
}

TEST(Wheel, FollowsItsMotors) {
  OneAxis effort(JointKind::revolute);
  effort.axis().motor = {.kind = MotorKind::effort, .target = [](double t) { return 3 * t; }};
  advance(MoreauJean(effort.model, {.h = 1e-2}, {.theta = 0.5}), effort.state, 1);
  EXPECT_NEAR(effort.speed(), 3 * 0.5 / 0.5, 1e-12);  // the midpoint rule integrates 3 t exactly

  OneAxis speed(JointKind::revolute);
  speed.axis().motor = {.kind = MotorKind::speed, .target = [](double t) { return std::sin(t); }};
  advance(MoreauJean(speed.model, {.h = 1e-2}, {.theta = 1}), speed.state, 0.5,
          [&](const StepReport&) { EXPECT_NEAR(speed.speed(), std::sin(speed.state.t), 1e-12); });

  OneAxis limited(JointKind::revolute);
  limited.axis().motor = {.kind = MotorKind::speed, .target = [](double) { return 4; }, .limit = 5};
  const MoreauJean scheme(limited.model, {.h = 1e-2}, {.theta = 1});
  advance(scheme, limited.state, 0.3,
          [&](const StepReport& r) { EXPECT_NEAR(r.joints[0].effort[0], 5, 1e-9); });
  EXPECT_NEAR(limited.speed(), 5 / 0.5 * 0.3, 1e-10);  // full torque
  advance(scheme, limited.state, 0.5);
  EXPECT_NEAR(limited.speed(), 4, 1e-10);  // and no more than the target

  for (const double theta : {0.5, 1.0})
    for (const bool project : {true, false}) {
      OneAxis position(JointKind::revolute);
      position.axis().motor = {.kind = MotorKind::position,
                               .target = [](double t) { return 20 * (1 - std::cos(t)); }};
      advance(MoreauJean(position.model, {.h = 1e-2, .joints = {.project = project}}, {.theta = theta}),
              position.state, 3, [&](const StepReport&) {
                EXPECT_NEAR(position.q(), 20 * (1 - std::cos(position.state.t)), project ? 1e-12 : 1e-4);
              });
      EXPECT_GT(position.q(), 6 * 2 * kPi);  // six turns
      EXPECT_NEAR(position.speed(), 20 * std::sin(3), project ? 1e-8 : 20 * 1e-2);
    }
}

TEST(Wheel, StopsBeyondHalfATurn) {
  OneAxis w(JointKind::revolute);
  w.axis() = {.lower = -1, .upper = 5 * kPi};
  w.axis().motor = {.kind = MotorKind::effort, .target = [](double) { return 10; }};
  advance(MoreauJean(w.model, {.h = 1e-2}, {.theta = 1}), w.state, 3);
  EXPECT_NEAR(w.q(), 5 * kPi, 1e-10);
  EXPECT_NEAR(w.speed(), 0, 1e-10);
}

// The torque on the first of two wheels turns both, by the ratio, over several turns.
TEST(GearPair, KeepsItsRatioAndItsEnergy) {
  GearPair gears;
  Model& model = gears.model;
  State& state = gears.state;
  const double acceleration = 7 / (0.5 + 3.0 / (2.5 * 2.5));
  const MoreauJean scheme(model, {.h = 1e-2}, {.theta = 0.5});
  advance(scheme, state, 3, [&](const StepReport& report) {
    EXPECT_NEAR(joint_coordinate(model, state, 0), -2.5 * joint_coordinate(model, state, 1), 1e-11);
    EXPECT_LT(std::abs(report.energy.joint_work), 1e-11);
    EXPECT_NEAR(report.joints[1].torque.y(), -3 * acceleration / 2.5, 1e-8);
  });
  EXPECT_NEAR(joint_speed(model, state, 0), 3 * acceleration, 1e-9);
  EXPECT_NEAR(joint_coordinate(model, state, 0), 4.5 * acceleration, 1e-8);  // five turns
}

TEST(Screw, RunsDownItsThread) {
  Model model;
  add(model, RigidBody{.name = "nut", .mass = 2, .inertia = 0.01 * Mat3::Identity()});
  State state = rest_state(model);
  add(model, Joint{.name = "thread", .kind = JointKind::screw, .body_a = 0, .pitch = 0.1});
  const double lead = 0.1 / (2 * kPi), acceleration = kG * 2 / (2 + 0.01 / (lead * lead));
  const MoreauJean scheme(model, {.h = 1e-2}, {.theta = 0.5});
  advance(scheme, state, 3, [&](const StepReport&) {
    EXPECT_NEAR(state.g[0].p.z(), lead * joint_coordinate(model, state, 0), 1e-12);
  });
  EXPECT_NEAR(state.g[0].p.z(), -0.5 * acceleration * 9, 1e-10);
  EXPECT_LT(state.turns[0], -20);
}

// Two shafts that meet at an angle, the forks of their joint across them: tan(out) = cos(bend) tan(in)
// (Hooke). One universal and two hinges have 14 equations for the 11 motions that they leave out.
TEST(Universal, TurnsAsHookeSays) {
  const double bend = 0.6;
  Model model;
  model.gravity = Vec3::Zero();
  for (int i = 0; i < 2; ++i)
    add(model, RigidBody{.name = "shaft", .mass = 1, .inertia = 0.1 * Mat3::Identity()});
  State state = rest_state(model);
  const SE3 out = rotation(Vec3::UnitX(), bend);
  add(model, joint_at(JointKind::revolute, "in", 0, kWorld, state.g, SE3{}));
  add(model, joint_at(JointKind::revolute, "out", 1, kWorld, state.g, out));
  add(model, Joint{.name = "cross",
                   .kind = JointKind::universal,
                   .body_a = 1,
                   .body_b = 0,
                   .frame_a = out * rotation(Vec3::UnitZ(), kPi / 2),  // its x: across the out shaft
                   .frame_b = rotation(Vec3::UnitY(), kPi / 2)});      // its z: across the in shaft
  model.joints[0].axis[0].motor = {.kind = MotorKind::position, .target = [](double t) { return 2 * t; }};
  advance(MoreauJean(model, {.h = 1e-2}, {.theta = 1}), state, 7, [&](const StepReport&) {
    const double a = joint_coordinate(model, state, 0), b = joint_coordinate(model, state, 1);
    EXPECT_NEAR(a, 2 * state.t, 1e-12);
    EXPECT_NEAR(std::sin(b - std::atan2(std::sin(a) * std::cos(bend), std::cos(a))), 0, 1e-11);
    EXPECT_NEAR(b, a, 0.2);  // turns together
  });
}

TEST(FreeChain, KeepsItsLinearMomentumToRoundingAndItsAngularMomentumToSecondOrder) {
  const auto change = [](double h, double& linear) {
    Random random(3);
    Model model;
    model.gravity = Vec3::Zero();
    for (int i = 0; i < 5; ++i) add(model, rod(1 + 0.2 * i));
    State state = rest_state(model);
    for (int i = 0; i < 5; ++i) state.g[BodyId::at(i)].p.x() = i;
    for (int i = 0; i < 4; ++i)
      add(model, joint_at(i % 2 ? JointKind::spherical : JointKind::universal, "joint", BodyId::at(i + 1),
                          BodyId::at(i), state.g, translation(i + 0.5, 0, 0)));
    for (int i = 0; i < 5; ++i) twist(state, BodyId::at(i)) << random.vector(1), random.vector(2);
    state = consistent_state(model, state);
    EXPECT_LT((consistent_velocity(model, state) - state.v).norm(), 1e-12);
    const Momentum before = momentum(model, state);
    advance(MoreauJean(model, {.h = h}, {.theta = 0.5}), state, 0.5);
    const Momentum after = momentum(model, state);
    linear = (after.linear - before.linear).norm() / before.linear.norm();
    return (after.angular - before.angular).norm();
  };
  double linear = 0;
  const double coarse = change(7e-3, linear), fine = change(2e-3, linear);
  EXPECT_LT(linear, 1e-13 * 250);  // 1e-13 in each of 250 steps
  EXPECT_NEAR(order(coarse, fine, 3.5), 2, 0.4);
}

// Each kind between two free bodies that tumble and are pulled at.
TEST(Mechanism, OfAnyKindHoldsAndDoesNoWorkAtThetaOneHalf) {
  for (const JointKind kind : {JointKind::fixed, JointKind::revolute, JointKind::prismatic,
                               JointKind::cylindrical, JointKind::spherical, JointKind::universal,
                               JointKind::planar, JointKind::screw, JointKind::distance}) {
    const auto lost = [&](double h) {
      Tumbling tumbling(kind);
      const Model& model = tumbling.model;
      State& state = tumbling.state;
      const double E = energy(model, state).total();
      const Vec3 p = momentum(model, state).linear;
      double worst = 0;
      advance(MoreauJean(model, {.h = h}, {.theta = 0.5}), state, 0.3, [&](const StepReport& report) {
        EXPECT_LT(report.joint_error.translation + report.joint_error.rotation, 1e-12) << to_string(kind);
        EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
        worst = std::max(worst, std::abs(energy(model, state).total() - E));
      });
      EXPECT_LT((momentum(model, state).linear - p).norm(), 1e-12);
      return worst;
    };
    const double coarse = lost(1e-2), fine = lost(3e-3);
    EXPECT_LT(fine, 2e-3) << to_string(kind);
    EXPECT_GT(order(coarse, fine, 10.0 / 3), 1.7) << to_string(kind);
  }
}

// A pinion on a rack: an angle coupled to a translation.
TEST(Rack, FollowsItsPinion) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, RigidBody{.name = "pinion", .mass = 1, .inertia = 0.5 * Mat3::Identity()});
  add(model, RigidBody{.name = "rack", .mass = 4, .inertia = Mat3::Identity()});
  State state = rest_state(model);
  state.g[1].p.z() = -0.3;
  add(model, joint_at(JointKind::revolute, "axle", 0, kWorld, state.g, kAboutY));
  add(model, joint_at(JointKind::prismatic, "slide", 1, kWorld, state.g,
                      translation(0, 0, -0.3) * rotation(Vec3::UnitY(), kPi / 2)));
  add(model, Coupling{.name = "teeth", .joint_1 = 1, .joint_2 = 0, .ratio = -0.3, .offset = 0});
  model.joints[0].axis[0].motor = {.kind = MotorKind::effort, .target = [](double) { return 2; }};
  advance(MoreauJean(model, {.h = 1e-2}, {.theta = 0.5}), state, 2);
  EXPECT_NEAR(joint_speed(model, state, 0), 2 * 2 / (0.5 + 4 * 0.09), 1e-9);
  EXPECT_NEAR(state.g[1].p.x(), -0.3 * joint_coordinate(model, state, 0), 1e-11);
}

// A crank that is moved along a recorded path drives a slider by a rod.
TEST(SliderCrank, FollowsACrankOnARecordedPath) {
  Model model;
  model.gravity = Vec3::Zero();
  const double crank = 0.2, length = 0.5;
  Trajectory path;
  for (int i = 0; i <= 400; ++i) {
    path.t.push_back(0.01 * i);
    path.pose.push_back(rotation(Vec3::UnitY(), -0.03 * i));  // 3 rad/s, x towards z
  }
  add(model, prescribed_body("crank", -1, path));
  add(model, rod(1, length));
  add(model, RigidBody{.name = "slider", .mass = 1, .inertia = Mat3::Identity()});
  State state = rest_state(model);
  state.g[1].p.x() = crank + length / 2;
  state.g[2].p.x() = crank + length;
  add(model, joint_at(JointKind::revolute, "pin", 1, 0, state.g, translation(crank, 0, 0) * kAboutY));
  add(model,
      joint_at(JointKind::revolute, "wrist", 2, 1, state.g, translation(crank + length, 0, 0) * kAboutY));
  add(model, joint_at(JointKind::prismatic, "guide", 2, kWorld, state.g,
                      translation(crank + length, 0, 0) * rotation(Vec3::UnitY(), kPi / 2)));
  advance(MoreauJean(model, {.h = 5e-3}, {.theta = 1}), state, 3.5, [&](const StepReport& report) {
    const double a = 3 * state.t;
    EXPECT_NEAR(state.g[2].p.x(),
                crank * std::cos(a) + std::sqrt(length * length - std::pow(crank * std::sin(a), 2)), 1e-10);
    EXPECT_LT(report.joint_error.translation, 1e-12);
  });
}

// A hinged flap falls on the ground: joints and contacts in one problem, one certified path.
TEST(Flap, FallsOnTheGroundAndLiesThere) {
  for (const double theta : {0.5, 1.0}) {
    Model model;
    model.contact_law = {.mu = 0.5};
    const SimplicialComplex box = make_box(0.4, 0.2, 0.05);
    const double radius = 1e-3;
    const ShapeId shape = add(model, prepare(dilate(box, radius)));
    add(model, fixed_body("ground", add(model, prepare(dilate(make_plate(3, 3), radius)))));
    add(model, solid_body("flap", shape, mass_properties(box, 1000)));
    State state = rest_state(model);
    const double height = 0.025 + 2 * radius;
    const SE3 hinge = translation(-0.3, 0, height) * kAboutY;
    state.g[1].p.z() = height;
    add(model, joint_at(JointKind::revolute, "hinge", 1, kWorld, state.g, hinge));
    const double up = -1.0;  // about +y: the far end rises
    state.g[1] = translation(-0.3, 0, height) * rotation(Vec3::UnitY(), up) * translation(0.3, 0, 0);
    double weight = 0;
    const MoreauJean scheme(model, {.h = 2e-3}, {.theta = theta});
    advance(scheme, state, 1, [&](const StepReport& report) {
      EXPECT_GT(report.min_base_distance, 1.9 * radius);
      EXPECT_LT(report.joint_error.translation, 1e-12);
      EXPECT_LT(std::abs(report.energy.residual()), 1e-11);
      weight = report.joints[0].force.z();
      for (const StepContact& c : report.contacts) weight -= c.impulse.z() / report.h;  // on A, the ground
    });
    EXPECT_NEAR(joint_coordinate(model, state, 0), 0, 1e-6);
    EXPECT_LT(twist(state, 1).norm(), 1e-6);
    EXPECT_NEAR(weight, 1000 * 0.4 * 0.2 * 0.05 * kG, 1e-4);
  }
}

TEST(Mechanism, GoesOnFromACopyWithTheSameBits) {
  const auto end = [](bool pause) {
    OneAxis w(JointKind::revolute);
    w.axis() = {.lower = -2, .upper = 7, .restitution = 0.5, .friction = 1};
    w.state.v[4] = 30;
    const MoreauJean scheme(w.model, {.h = 3e-3}, {.theta = 1});
    for (int i = 0; i < 300; ++i) {
      if (pause && i == 120) {
        State copy = w.state;
        EXPECT_TRUE(scheme.step(w.state).ok());
        w.state = copy;
      }
      EXPECT_TRUE((pause ? MoreauJean(w.model, {.h = 3e-3}, {.theta = 1}) : scheme).step(w.state).ok());
    }
    return hash(w.state);
  };
  EXPECT_EQ(end(true), end(false));
}

TEST(JointOptions, AreRefusedOutsideTheirRange) {
  const Chain c(1);
  EXPECT_NE(message_of([&] {
              MoreauJean(c.model, {.joints = {.stabilisation = 1.5}});
            }).find("JointOptions::stabilisation = 1.5 must lie in [0, 1]"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
