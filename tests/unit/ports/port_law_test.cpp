// SPDX-License-Identifier: Apache-2.0
// The law of a port against differences of its potential (PORT-6) to (PORT-8).
#include "ports/port_law.hpp"

#include <cmath>

#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/model.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/state.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

struct Held {
  Model model{};
  State state{};
  BodyId body{}, handle{};
};

Held held(const PortHold& hold, Random& random, const PortLimits& limits = {}) {
  Held out;
  out.body = add(out.model, RigidBody{.name = "part", .mass = 1, .inertia = Mat3::Identity()});
  RigidBody handle = fixed_body("handle", {});
  handle.motion = DrivenMotion{};
  out.handle = add(out.model, std::move(handle));
  (void)add_port_law(out.model, out.body, out.handle, limits);
  out.state = rest_state(out.model);
  for (const BodyId b : {out.body, out.handle}) {
    pose(out.state, b) = random.pose(0.3);
    twist(out.state, b) << random.vector(3), random.vector(3);
  }
  set_port_hold(out.state, 0, hold);
  return out;
}

PortHold gripped() {
  return {.gains = {.stiffness = 300, .damping = 7, .rotation_stiffness = 4, .rotation_damping = 0.3},
          .grip = {0.1, -0.2, 0.05},
          .brake = 2,
          .rotation_brake = 0.4};
}

GeneralisedForce force_of(const Held& now, const State& state) {
  GeneralisedForce out{.f = VecX::Zero(state.v.size())};
  now.model.forces[0].add_to(now.model, state, state.t, out);
  return out;
}
State nudged(const Held& now, int entry, double by) {
  return retract(now.model, now.state, VecX::Unit(now.state.v.size(), entry), by);
}

// Of springs alone: on the body and, for the hand, on the handle.
TEST(PortLaw, PushesBodyAndHandleDownThePotential) {
  Random random(3);
  for (const double limit : {kInf, 20.0}) {
    PortHold hold = gripped();
    hold.gains.damping = hold.gains.rotation_damping = hold.brake = hold.rotation_brake = 0;
    for (int k = 0; k < 20; ++k) {
      const Held now = held(hold, random, {.force = limit, .torque = limit / 10});
      const GeneralisedForce force = force_of(now, now.state);
      const auto U = [&](const State& state) { return now.model.forces[0].potential(now.model, state, 0); };
      for (int i = 0; i < now.state.v.size(); ++i) {
        const double slope = (U(nudged(now, i, 1e-5)) - U(nudged(now, i, -1e-5))) / 2e-5;
        EXPECT_NEAR(force.f[i], -slope, 1e-6 * (1 + force.f.norm())) << "entry " << i << ", limit " << limit;
      }
    }
  }
}

TEST(PortLaw, KnowsHowItsForcesChange) {
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    const Held now = held(gripped(), random);
    const GeneralisedForce force = force_of(now, now.state);
    MatX K = MatX::Zero(12, 12), C = K;
    for (const Triplet& e : force.K) K(e.row(), e.col()) += e.value();
    for (const Triplet& e : force.C) C(e.row(), e.col()) += e.value();
    for (int i = 0; i < 6; ++i) {  // of the body, on the body
      const double d = 1e-6;
      const VecX by_q = (force_of(now, nudged(now, i, d)).f - force_of(now, nudged(now, i, -d)).f) / (2 * d);
      State more = now.state, less = now.state;
      more.v[i] += d, less.v[i] -= d;
      const VecX by_v = (force_of(now, more).f - force_of(now, less).f) / (2 * d);
      EXPECT_LT((K.col(i).head<6>() + by_q.head<6>()).norm(), 1e-5 * (1 + by_q.norm())) << i;
      EXPECT_LT((C.col(i).head<6>() + by_v.head<6>()).norm(), 1e-7 * (1 + by_v.norm())) << i;
    }
  }
}

// What moves as a whole feels no damper.
TEST(PortLaw, IsAtRestWhereBodyAndHandleMoveTogether) {
  Random random(5);
  PortHold hold = gripped();
  hold.brake = hold.rotation_brake = 0;
  Held now = held(hold, random);
  const SE3 g = pose(now.state, now.body);
  pose(now.state, now.handle) = {g.R, g * gripped().grip};
  const Vec3 v = random.vector(1), omega = random.vector(2);
  twist(now.state, now.body) << v, omega;
  twist(now.state, now.handle) << v + g.R * omega.cross(gripped().grip), omega;
  EXPECT_LT(force_of(now, now.state).f.norm(), 1e-12);
}

// Over a step as over a path: the handle goes on while the law is evaluated.
TEST(PortLaw, LetsAPartThatIsLedAtAConstantSpeedLagByNothing) {
  Random random(8);
  Held now = held(
      {.gains = {.stiffness = 2e3, .damping = 40, .rotation_stiffness = 2, .rotation_damping = 0.1}}, random);
  now.model.gravity.setZero();
  pose(now.state, now.body) = pose(now.state, now.handle);
  twist(now.state, now.body) << 0.3, -0.1, 0.2, 0, 0, 0.5;
  twist(now.state, now.handle) = twist(now.state, now.body);
  const PassiveMidpoint scheme(now.model, {.h = 0.01, .update = GroupUpdate::cayley});
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(scheme.step(now.state).ok());
    EXPECT_LT((pose(now.state, now.body).p - pose(now.state, now.handle).p).norm(), 1e-12);
  }
}

// (PORT-1) for a translation: what the hand gives is stored, or taken by the damper.
TEST(PortLaw, StoresWhatTheHandGives) {
  Random random(9);
  const PortHold hold{.gains = {.stiffness = 2e3, .damping = 40, .rotation_stiffness = 2}};
  Held now = held(hold, random);
  now.model.gravity.setZero();
  pose(now.state, now.body) = pose(now.state, now.handle) = {};
  twist(now.state, now.body).setZero();
  twist(now.state, now.handle).setZero();
  const double h = 0.01;
  const PassiveMidpoint scheme(now.model, {.h = h, .update = GroupUpdate::cayley});
  const auto stored = [&] {
    const Energy e = energy(now.model, now.state);
    return e.kinetic + e.laws;
  };
  for (int k = 0; k < 100; ++k) {
    twist(now.state, now.handle).head<3>() = random.vector(1);
    const Vec3 v_h = twist(now.state, now.handle).head<3>(), v = twist(now.state, now.body).head<3>();
    const double before = stored();
    ASSERT_TRUE(scheme.step(now.state).ok());
    const Vec3 after = twist(now.state, now.body).head<3>(), pull = (after - v) / h;  // of 1 kg
    const double taken = h * hold.gains.damping * (v_h - (v + after) / 2).squaredNorm();
    EXPECT_NEAR(h * pull.dot(v_h), stored() - before + taken, 1e-12) << k;
  }
}

TEST(PortLaw, HoldsNoAttitudeByAGripAlone) {
  Random random(6);
  PortHold hold = gripped();
  hold.gains.rotation_stiffness = hold.gains.rotation_damping = 0;
  const Held now = held(hold, random);
  const auto at = [&](BodyId b) { return TrajectoryPoint{pose(now.state, b), twist(now.state, b)}; };
  const PortPull pull = port_pull(at(now.body), at(now.handle), hold, {});
  EXPECT_EQ(pull.torque, Vec3(Vec3::Zero()));
  EXPECT_GT(pull.force.norm(), 0);
}

TEST(PortLaw, RefusesWhatItCannotHold) {
  Model model;
  const BodyId body = add(model, RigidBody{.name = "part", .mass = 1, .inertia = Mat3::Identity()});
  const BodyId wall = add(model, fixed_body("wall", {}));
  expect_names(message_of([&] { (void)add_port_law(model, body, body, {}); }), "neither dynamic nor carried");
  expect_names(message_of([&] { (void)add_port_law(model, wall, wall, {}); }), "must be dynamic");
  expect_names(message_of([&] { (void)add_port_law(model, 7, wall, {}); }), "body = 7 must lie in [0, 2)");
  expect_names(message_of([&] { (void)add_port_law(model, body, wall, {.force = 0}); }), "force = 0");
  expect_names(message_of([] { validate(PortGains{.stiffness = -1}); }), "stiffness = -1");
}

// Each port has a hold of its own.
TEST(PortHold, StandsInTheState) {
  Random random(8);
  Held scene = held(gripped(), random);
  const int second = add_port_law(scene.model, scene.body, scene.handle, {});
  State state = rest_state(scene.model);
  EXPECT_EQ(port_hold(state, second).gains.stiffness, 0);
  set_port_hold(state, second, gripped());
  EXPECT_EQ(port_hold(state, 0).gains.stiffness, 0);
  const PortHold now = port_hold(state, second);
  EXPECT_EQ(now.gains.stiffness, 300);
  EXPECT_EQ(now.gains.rotation_damping, 0.3);
  EXPECT_EQ(now.grip, gripped().grip);
  EXPECT_EQ(now.brake, 2);
  EXPECT_EQ(now.rotation_brake, 0.4);
}

}  // namespace
}  // namespace aussois
