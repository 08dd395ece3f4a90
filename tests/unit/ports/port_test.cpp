// SPDX-License-Identifier: Apache-2.0
// How handle and hold follow a hand (PORT-9) to (PORT-11).
#include "ports/port.hpp"

#include <cmath>

#include "geometry/primitives.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/model.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/state.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

constexpr double kTick = 1e-3, kDilation = 1e-3;

struct Desk {
  Model model{};
  State state{};
  Port port{};
};
// A cube above a plate, without weight.
Desk desk(const PortOptions& options = {.gains = {.stiffness = 2e3, .rotation_stiffness = 2}}) {
  Desk out;
  out.model.gravity = Vec3::Zero();
  const ShapeId cube = add(out.model, prepare(dilate(make_box(0.02, 0.02, 0.02), kDilation)));
  const ShapeId plate = add(out.model, prepare(dilate(make_plate(1, 1), kDilation)));
  RigidBody part{.name = "part", .mass = 0.3, .inertia = 3e-5 * Mat3::Identity()};
  part.shape = cube;
  const BodyId body = add(out.model, std::move(part));
  add(out.model, fixed_body("plate", plate));
  out.port = add_port(out.model, body, options);
  out.state = rest_state(out.model);
  pose(out.state, body).p.z() = 0.05;
  return out;
}
// Takes the spin of a body, with a hundredth of a second's time constant.
ForceLaw air(BodyId body) {
  return {.name = "air", .add_to = [body](const Model&, const State& state, double, GeneralisedForce& sum) {
            angular_part(sum.f, body) -= 3e-3 * angular_part(state.v, body);
            add_block(sum.C, first_velocity(body) + 3, first_velocity(body) + 3, 3e-3 * Mat3::Identity());
          }};
}
PortTarget to(const Vec3& place) {
  return {.mode = PortTarget::Mode::pose, .pose = translation(place.x(), place.y(), place.z())};
}
void run_ticks(Desk& now, const PortTarget& target, int ticks) {
  const PassiveMidpoint scheme(now.model, {.h = kTick, .update = GroupUpdate::cayley});
  for (int k = 0; k < ticks; ++k) {
    (void)follow(now.model, now.state, now.port, target, kTick);
    ASSERT_TRUE(scheme.step(now.state).ok());
  }
}

TEST(Port, TakesHoldWithoutAPull) {
  Desk now = desk();
  EXPECT_FALSE(is_held(now.state, now.port));
  EXPECT_EQ(follow(now.model, now.state, now.port, to({0, 0, 0.05}), kTick), 0);
  EXPECT_TRUE(is_held(now.state, now.port));
  EXPECT_EQ(pose(now.state, now.port.handle).p, pose(now.state, now.port.body).p);
  EXPECT_NEAR(port_hold(now.state, now.port.place).gains.stiffness, 2e3 * kTick / 0.2, 1e-9);  // it grows
  run_ticks(now, to({0, 0, 0.05}), 250);
  EXPECT_EQ(port_hold(now.state, now.port.place).gains.stiffness, 2e3);
  EXPECT_LT((pose(now.state, now.port.body).p - Vec3(0, 0, 0.05)).norm(), 1e-12);
}

TEST(Port, LeadsAPartByItsGrip) {
  Desk now = desk();
  PortTarget target = to({0.012, 0, 0.06});
  target.grip = {0.01, 0, 0};
  run_ticks(now, target, 1500);
  EXPECT_LT((pose(now.state, now.port.body) * target.grip - target.pose.p).norm(), 1e-6);
}

// By one point it hangs: its weight turns it until the point is above its centre.
TEST(Port, LetsAPartHangByItsGrip) {
  Desk now = desk();
  now.model.gravity = {0, 0, -kGravity};
  now.model.forces.push_back(air(now.port.body));
  PortTarget target = to({0, 0, 0.3});
  pose(now.state, now.port.body).p.z() = 0.29;
  target.grip = {0.01, 0, 0.001};
  target.firm = false;
  run_ticks(now, target, 4000);
  const Vec3 arm = pose(now.state, now.port.body).R * target.grip;
  EXPECT_LT(arm.head<2>().norm(), 1e-3 * arm.norm());
  EXPECT_GT(arm.z(), 0);
}

// Two hands hold a part at its two ends, each with a hold of its own.
TEST(Port, SharesAPartWithAnother) {
  Desk now = desk();
  const Port second = add_port(now.model, now.port.body, now.port.options);
  now.state = rest_state(now.model);
  pose(now.state, now.port.body).p.z() = 0.05;
  PortTarget left = to({-0.01, 0, 0.06}), right = to({0.01, 0, 0.06});
  left.grip = {-0.01, 0, 0}, right.grip = {0.01, 0, 0};
  left.firm = right.firm = false;
  const PassiveMidpoint scheme(now.model, {.h = kTick, .update = GroupUpdate::cayley});
  for (int k = 0; k < 1500; ++k) {
    (void)follow(now.model, now.state, now.port, left, kTick);
    (void)follow(now.model, now.state, second, right, kTick);
    ASSERT_TRUE(scheme.step(now.state).ok());
  }
  EXPECT_NEAR(pose(now.state, now.port.body).p.z(), 0.06, 1e-6);
  EXPECT_EQ(port_hold(now.state, second.place).grip, right.grip);
  EXPECT_EQ(port_hold(now.state, now.port.place).grip, left.grip);
}

// The handle goes on at its stride, however far the hand is.
TEST(Port, GoesNoFasterThanItsStride) {
  Desk now = desk();
  (void)follow(now.model, now.state, now.port, to({1, 0, 0.05}), kTick);
  EXPECT_NEAR(kTick * twist(now.state, now.port.handle).head<3>().norm(), 4 * 2 * kDilation, 1e-12);
  PortTarget turning{.mode = PortTarget::Mode::twist, .twist = Vec6::Unit(5) * 1e4};
  (void)follow(now.model, now.state, now.port, turning, kTick);
  const LmdShape& cube = *now.model.shapes[0];
  EXPECT_NEAR(
      kTick * twist(now.state, now.port.handle).tail<3>().norm() * (cube.bounding_radius + cube.radius),
      4 * 2 * kDilation, 1e-12);
}

// A thinner part that came later counts too.
TEST(Port, CountsItsStrideInTheThinnestDilations) {
  Desk now = desk();
  const ShapeId thin = add(now.model, prepare(dilate(make_box(0.1, 0.1, 0.1), 0.1 * kDilation)));
  add(now.model, fixed_body("thin", thin));
  now.state = rest_state(now.model);
  (void)follow(now.model, now.state, now.port, to({1, 0, 0.05}), kTick);
  EXPECT_NEAR(kTick * twist(now.state, now.port.handle).head<3>().norm(), 4 * 1.1 * kDilation, 1e-12);
}

// Pushed on by a speed against a stop, the handle waits where the pull is at its limit, and comes back at
// once.
TEST(Port, DoesNotWindUpAgainstAStop) {
  Desk now =
      desk({.gains = {.stiffness = 2e3, .rotation_stiffness = 2}, .limits = {.force = 10, .torque = 1}});
  pose(now.state, now.port.body).p.z() = 0.0121;
  PortTarget down{.mode = PortTarget::Mode::twist};
  down.twist[2] = -0.05;
  run_ticks(now, down, 1000);
  const auto stretch = [&] {
    return (pose(now.state, now.port.handle).p - pose(now.state, now.port.body).p).norm();
  };
  EXPECT_LT(stretch(), 10 / 2e3 + 0.05 * 0.2);  // of the limit, and while the gains grow
  down.twist[2] = 0.05;
  run_ticks(now, down, 200);
  EXPECT_GT(pose(now.state, now.port.body).p.z(), 0.0125);
}

// What was in the springs is gone, the part is braked, and then it is free.
TEST(Port, LetsGoWithBrakesThatFade) {
  Desk now = desk();
  run_ticks(now, to({0, 0, 0.05}), 250);
  run_ticks(now, to({0.05, 0, 0.05}), 20);
  const double fast = twist(now.state, now.port.body).head<3>().norm();
  EXPECT_GT(fast, 0.1);
  run_ticks(now, {}, 1);
  EXPECT_FALSE(is_held(now.state, now.port));
  EXPECT_EQ(port_energy({}, {translation(1, 0, 0)}, port_hold(now.state, now.port.place), {}), 0);
  run_ticks(now, {}, 210);
  EXPECT_EQ(port_hold(now.state, now.port.place).brake, 0);
  EXPECT_LT(twist(now.state, now.port.body).head<3>().norm(), 0.02 * fast);
}

// A hand that takes hold of a body that moves, and gains that grow on a stretched spring: the energy is told.
TEST(Port, TellsWhatGrowingGainsPutIn) {
  Desk now = desk();
  twist(now.state, now.port.body)[0] = 0.2;
  const PassiveMidpoint scheme(now.model, {.h = kTick, .update = GroupUpdate::cayley});
  const auto all = [&] {
    const Energy e = energy(now.model, now.state);
    return e.kinetic + e.laws;
  };
  double put_in = 0, last = all();
  for (int k = 0; k < 400; ++k) {
    const double more = follow(now.model, now.state, now.port, to({0, 0, 0.05}), kTick);
    put_in += more;
    EXPECT_LE(all(), last + more + 1e-15);
    ASSERT_TRUE(scheme.step(now.state).ok());
    last = all();
  }
  EXPECT_GT(put_in, 0);
}

TEST(Port, GoesOnWithTheSameBitsFromACopy) {
  Desk now = desk();
  run_ticks(now, to({0, 0.01, 0.04}), 70);
  Desk copy = desk();
  copy.state = now.state;
  run_ticks(now, to({0, 0, 0}), 300);
  run_ticks(copy, to({0, 0, 0}), 300);
  EXPECT_EQ(hash(now.state), hash(copy.state));
}

TEST(Port, RefusesWhatItCannotFollow) {
  Desk now = desk();
  const auto told = [&](const PortTarget& target, double tick = kTick) {
    return message_of([&] { (void)follow(now.model, now.state, now.port, target, tick); });
  };
  expect_names(told(to({0, 0, 0}), 0), "tick = 0 must be positive");
  expect_names(told(to({0, kInf, 0})), "PortTarget::pose");
  expect_names(told({.mode = PortTarget::Mode::twist, .twist = Vec6::Constant(kInf)}),
               "twist must be finite");
  Desk other = desk();
  expect_names(message_of([&] {
                 (void)follow(other.model, other.state, other.port,
                              {.mode = PortTarget::Mode::pose, .grip = {kInf, 0, 0}}, kTick);
               }),
               "grip must be finite");
  expect_names(message_of([] { (void)desk({.ramp = 0}); }), "ramp = 0");
  expect_names(message_of([] { (void)desk({.stride = -1}); }), "stride = -1");
  expect_names(message_of([] {
                 Model empty;
                 (void)add_port(empty, 0, {});
               }),
               "body = 0 must lie in [0, 0)");
}

}  // namespace
}  // namespace aussois
