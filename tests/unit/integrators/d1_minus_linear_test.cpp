// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/d1_minus_linear.hpp"

#include "mechanics/joint.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

Scene falling_block(double e, double height) {
  Scene s = block_on_plate(0, e, 0, height);
  twist(s.state, s.block)[2] = -0.1;
  return s;
}

// A block that slides in one direction all the time under m g (1 + sin 20 t) / 2 along x: contact lasts, so
// the order is two. x'' = g ((1 + sin 20 t) / 2 - mu).
TEST(D1MinusLinear, IsOfOrderTwoWhileContactLasts) {
  constexpr double kMu = 0.2, kW = 20, kStart = 2, kEnd = 0.5;
  const auto error = [](double h) {
    Scene s = block_on_plate(kMu, 0, 0);
    s.model.forces.push_back(
        {.name = "push",
         .add_to =
             [body = s.block](const Model& model, const State&, double t, GeneralisedForce& force) {
               force.f[first_velocity(body)] +=
                   model.bodies[body].mass * kGravity * (1 + std::sin(kW * t)) / 2;
             },
         .potential = {}});
    twist(s.state, s.block)[0] = kStart;
    const D1MinusLinear scheme(s.model, {.h = h, .solver = {.tolerance = 1e-12}});
    while (s.state.t < kEnd - h / 2) {
      const StepReport report = scheme.step(s.state);
      EXPECT_TRUE(report.ok()) << report.reason;
      if (!report.ok()) break;
      EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
      EXPECT_LT(report.energy.contact_work, 0);
    }
    const double v = kStart + kGravity * ((0.5 - kMu) * kEnd + (1 - std::cos(kW * kEnd)) / (2 * kW));
    return std::abs(twist(s.state, s.block)[0] - v);
  };
  EXPECT_GT(std::log2(error(1e-2) / error(5e-3)), 1.9);
}

// Back with e, at the end of the step in which the gap closes; between impacts the energy is exact.
TEST(D1MinusLinear, BouncesByNewtonsLaw) {
  for (const double e : {0.6, 1.0}) {
    Scene s = falling_block(e, 0.01);
    const D1MinusLinear scheme(s.model, {.h = 1e-3});
    const double E = energy(s.model, s.state).total();
    double before = -0.1;
    bool back = false;
    for (int k = 0; k < 60; ++k) {
      const double h_start = s.state.t;
      const StepReport report = scheme.step(s.state);
      ASSERT_TRUE(report.ok());
      EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
      const double now = twist(s.state, s.block)[2], h = s.state.t - h_start;
      if (before < 0 && now > 0) {
        EXPECT_NEAR(now, -e * (before - kGravity * h), 1e-9);
        back = true;
      }
      before = now;
      if (e == 1) {
        EXPECT_NEAR(energy(s.model, s.state).total(), E, 1e-9);
      }
    }
    EXPECT_TRUE(back);
  }
}

TEST(D1MinusLinear, LetsNoBlockCreep) {
  Scene s = block_on_plate(0.5, 0, 0.2);
  const Vec3 start = pose(s.state, s.block).p;
  const D1MinusLinear scheme(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-11}});
  for (int k = 0; k < 1000; ++k) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    Vec3 sum = Vec3::Zero();  // of both stages: the weight over the step
    for (const StepContact& contact : report.contacts) sum += contact.impulse;
    const double mass = s.model.bodies[s.block].mass;
    ASSERT_LT((sum - report.h * mass * s.model.gravity).norm(), 1e-8);  // A is the plate
  }
  EXPECT_LT((pose(s.state, s.block).p - start).norm(), 1e-9);
}

// A flap on a hinge falls on a stop of its axis and comes back: joints, an impact on an axis, dry friction.
TEST(D1MinusLinear, TakesJointsStopsAndDryFriction) {
  Model model;
  add(model, RigidBody{.name = "rod", .mass = 2, .inertia = Vec3(0.2, 0.2, 0.01).asDiagonal()});
  State state = rest_state(model);
  pose(state, 0).p = Vec3(1, 0, 0);
  const SE3 about_y{rotation(Vec3::UnitX(), -kPi / 2).R, Vec3::Zero()};
  add(model, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g, about_y));
  JointAxis& axis = model.joints[0].axis[0];
  axis.lower = -0.5, axis.upper = 0.5, axis.restitution = 0.5, axis.friction = 0.2;
  const D1MinusLinear scheme(model, {.h = 1e-3});
  double largest = 0, fastest_back = 0;
  for (int k = 0; k < 1500; ++k) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
    EXPECT_LT(report.joint_error.translation, 1e-13);
    largest = std::max(largest, std::abs(joint_coordinate(model, state, 0)));
    fastest_back = std::max(fastest_back, twist(state, 0)[2]);
  }
  EXPECT_LT(largest, 0.5 + 5e-3);  // h times the speed of the impact
  EXPECT_GT(fastest_back, 0.5);
  EXPECT_LT(state.v.norm(), 1e-6);  // at rest on the stop
}

// z'' = -z above a stop at -1/2: the impact as in A2.
TEST(D1MinusLinear, StepsCoordinatesAndGapFunctions) {
  Model model;
  add(model, Coordinates{.name = "z",
                         .size = 1,
                         .mass = [](const VecX&) { return MatX::Identity(1, 1); },
                         .force = [](double, const VecX& q,
                                     const VecX&) { return CoordinateForce{.f = -q, .K = {}, .C = {}}; },
                         .potential = [](const VecX& q) { return q.squaredNorm() / 2; }});
  add(model, GapFunction{.name = "stop",
                         .block = 0,
                         .evaluate =
                             [](const Model&, const State& state, double) {
                               return GapRows{.gap = state.q[0] + 0.5, .J = MatX::Identity(1, 1), .rate = {}};
                             },
                         .law = {.mu = 0, .restitution = 0.8}});
  State state = rest_state(model);
  state.q[0] = 1;
  const D1MinusLinear scheme(model, {.h = 1e-3});
  while (state.t < 3) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok());
    EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
  }
  EXPECT_NEAR(energy(model, state).total(), 0.5 * 0.64 * 0.75 + 0.125, 2e-3);
}

// 100 N/m on 1 kg: 2 / omega is 0.2 s.
TEST(D1MinusLinear, IsStableToTheBoundOfExplicitSchemes) {
  const auto amplitude = [](double h) {
    Model model;
    model.gravity = Vec3::Zero();
    add(model, RigidBody{.name = "mass", .mass = 1, .inertia = Mat3::Identity()});
    model.forces.push_back(
        {.name = "spring",
         .add_to = [](const Model&, const State& s, double,
                      GeneralisedForce& force) { force.f[0] -= 100 * s.g[0].p.x() + 4 * s.v[0]; },
         .potential = {}});
    State state = rest_state(model);
    pose(state, 0).p.x() = 1;
    const D1MinusLinear scheme(model, {.h = h});
    for (int k = 0; k < 60; ++k) EXPECT_TRUE(scheme.step(state).ok());
    return std::abs(pose(state, 0).p.x());
  };
  EXPECT_LT(amplitude(0.05), 1);
  EXPECT_GT(amplitude(0.25), 1);
}

TEST(D1MinusLinear, GivesTheSameBitsAfterACopyAndByAFreshScheme) {
  Scene s = block_on_plate(0.3, 0.5, 0.2, 0.01);
  twist(s.state, s.block).tail<3>() = Vec3(3, 2, 1);
  const StepOptions options{.h = 1e-3};
  const D1MinusLinear scheme(s.model, options);
  State state = s.state;
  for (int k = 0; k < 100; ++k) {
    State copy = state;
    ASSERT_TRUE(scheme.step(state).ok());
    ASSERT_TRUE(D1MinusLinear(s.model, options).step(copy).ok());
    ASSERT_EQ(hash(state), hash(copy)) << "step " << k;
  }
}

TEST(D1MinusLinear, RefusesBadOptions) {
  const Scene s = block_on_plate(0, 0, 0);
  EXPECT_NE(message_of([&] { D1MinusLinear(s.model, {.h = 0}); }).find("StepOptions::h = 0"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
