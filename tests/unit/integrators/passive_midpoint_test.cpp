// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/passive_midpoint.hpp"

#include "mechanics/joint.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

Model free_body(const Mat3& inertia, double mass = 1) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, RigidBody{.name = "body", .mass = mass, .inertia = inertia});
  return model;
}

State spinning(const Model& model, const Vec3& omega) {
  State state = rest_state(model);
  twist(state, 0).tail<3>() = omega;
  return state;
}

StepOptions exact(double h) {
  return {.h = h, .update = GroupUpdate::cayley};
}

// Whatever the step: 0.1 s is a tenth of a turn.
TEST(FreeTop, KeepsEnergyAndMomentumInSpaceToRounding) {
  const Model model = free_body(Vec3(3, 2, 1).asDiagonal());
  for (const double h : {1e-3, 1e-1}) {
    State state = spinning(model, {0.6, 1, 1.3});
    const double E = energy(model, state).kinetic;
    const Vec3 L = momentum(model, state).angular;
    const PassiveMidpoint scheme(model, exact(h));
    for (int k = 0; k < 10000; ++k) ASSERT_TRUE(scheme.step(state).ok());
    EXPECT_NEAR(energy(model, state).kinetic / E, 1, 1e-12) << "h = " << h;
    EXPECT_LT((momentum(model, state).angular - L).norm() / L.norm(), 1e-12) << "h = " << h;
  }
}

// Steps of several radians, in which Newton's method for the torque may not settle: such a step is shortened.
TEST(FreeTop, KeepsEnergyInStepsOfSeveralRadians) {
  const Model model = free_body(Vec3(1, 10, 11).asDiagonal());
  const PassiveMidpoint scheme(model, exact(1));
  Random random(5);
  int shortened = 0;
  for (int k = 0; k < 1000; ++k) {
    State state = spinning(model, random.vector_of_length(2, 5));
    const double E = energy(model, state).kinetic;
    const Vec3 L = momentum(model, state).angular;
    const StepReport report = scheme.step(state);
    shortened += report.h < 1;
    if (!report.ok()) continue;
    ASSERT_NEAR(energy(model, state).kinetic / E, 1, 1e-12) << k;
    ASSERT_LT((momentum(model, state).angular - L).norm() / L.norm(), 1e-12) << k;
  }
  EXPECT_GT(shortened, 10);
}

// The numbers of the manual, with the torque of the start: energy exact, momentum grows, order one.
TEST(FreeTop, GainsMomentumWithTheTorqueOfTheStart) {
  const Model model = free_body(Vec3(1, 2, 3).asDiagonal());
  const std::vector<std::pair<double, double>> growth = {{20e-3, 0.059}, {10e-3, 0.028}, {5e-3, 0.013}};
  for (const auto& [h, percent] : growth) {
    State state = spinning(model, {0.3, 2, 0.4});
    const double E = energy(model, state).kinetic, L = momentum(model, state).angular.norm();
    const PassiveMidpoint scheme(model, {.h = h}, {.gyroscopic = GyroscopicTerm::start});
    while (state.t < 10 - h / 2) ASSERT_TRUE(scheme.step(state).ok());
    EXPECT_NEAR(energy(model, state).kinetic / E, 1, 1e-12);
    EXPECT_NEAR(momentum(model, state).angular.norm() / L - 1, percent, 1e-3) << "h = " << h;
  }
}

// D1: a state 2.75e-10 off the separatrix flips at the right times only if energy and momentum stay.
TEST(FreeTop, FlipsAsDzhanibekovSawIt) {
  const Model model = free_body(Vec3(1, 10, 11).asDiagonal());
  State state = spinning(model, {0, 2, 1e-4});
  const double E = energy(model, state).kinetic;
  const Vec3 L = momentum(model, state).angular;
  const double h = 5e-3;
  const PassiveMidpoint scheme(model, exact(h));
  std::vector<double> flips;
  while (state.t < 32) {
    const double before = twist(state, 0)[4], t = state.t;
    ASSERT_TRUE(scheme.step(state).ok());
    const double after = twist(state, 0)[4];
    if (before * after < 0) flips.push_back(t + h * before / (before - after));
    ASSERT_NEAR(energy(model, state).kinetic / E, 1, 1e-12);
    ASSERT_LT((momentum(model, state).angular - L).norm() / L.norm(), 1e-12);
  }
  const std::vector<double> exact_flips = {6.18519931, 18.55559833, 30.92599685};
  ASSERT_EQ(flips.size(), exact_flips.size());
  // Order two: the midpoint rule on the body rates is 3e-5 s early at the first flip, and five times that at
  // the third
  for (std::size_t i = 0; i < flips.size(); ++i)
    EXPECT_NEAR(flips[i], exact_flips[i], 4e-5 * double(2 * i + 1));
}

TEST(PathVelocity, LeadsToTheCayleyTransform) {
  const Model model = free_body(Mat3::Identity());
  Random random(7);
  for (int k = 0; k < 50; ++k) {
    State state = rest_state(model);
    state.g[0].R = random.rotation();
    state.v << random.vector(3), random.vector(3);
    const double h = random.uniform(1e-3, 1);
    const VecX path = path_velocity(GroupUpdate::cayley, model, state, state.v, h);
    const Mat3 half = h / 2 * skew(state.v.tail<3>());
    const Mat3 cayley = (Mat3::Identity() - half).inverse() * (Mat3::Identity() + half);
    const SE3 end = moved_poses(model, state, path, h)[0];
    EXPECT_LT((end.R.toRotationMatrix() - state.g[0].R.toRotationMatrix() * cayley).norm(), 1e-14);
    EXPECT_LT((end.p - h * state.v.head<3>()).norm(), 1e-15);
  }
}

TEST(PathVelocity, LeadsToTheEndOfTheScrew) {
  const Model model = free_body(Mat3::Identity());
  Random random(8);
  for (int k = 0; k < 50; ++k) {
    State state = rest_state(model);
    state.g[0] = random.pose(2);
    state.v << random.vector(3), random.vector(3);
    const double h = random.uniform(1e-3, 1);
    const Vec3 omega = state.v.tail<3>();
    Vec6 twist_of_middle;
    twist_of_middle << (state.g[0].R * exp_so3(h / 2 * omega)).conjugate() * Vec3(state.v.head<3>()), omega;
    const SE3 screw = state.g[0] * exp_se3(h * twist_of_middle);
    const SE3 end =
        moved_poses(model, state, path_velocity(GroupUpdate::screw, model, state, state.v, h), h)[0];
    EXPECT_LT((end.p - screw.p).norm(), 1e-14);
    EXPECT_LT(angle_between(end.R, screw.R), 1e-14);
  }
}

// A spring of 100 N/m, 300 periods of 30 steps each.
TEST(PassiveMidpoint, LetsASpringSwingWithoutLoss) {
  Model model = free_body(Mat3::Identity());
  model.forces.push_back({.name = "spring",
                          .add_to =
                              [](const Model&, const State& state, double, GeneralisedForce& force) {
                                force.f[0] -= 100 * state.g[0].p.x();
                                force.K.emplace_back(0, 0, 100.0);
                              },
                          .potential = [](const Model&, const State& state,
                                          double) { return 50 * std::pow(state.g[0].p.x(), 2); }});
  State state = rest_state(model);
  pose(state, 0).p.x() = 1;
  const double E = energy(model, state).total();
  const PassiveMidpoint scheme(model, exact(2 * kPi / 10 / 30));
  for (int k = 0; k < 9000; ++k) ASSERT_TRUE(scheme.step(state).ok());
  EXPECT_NEAR(energy(model, state).total() / E, 1, 1e-12);
}

// A top on its tip, joints projected: its energy returns to second order, and the ledger closes in each step.
TEST(PassiveMidpoint, KeepsTheEnergyOfATopOnItsTipToSecondOrder) {
  const auto lost = [](double h) {
    Model model;
    add(model, RigidBody{.name = "top", .mass = 2, .inertia = Vec3(0.2, 0.1, 0.2).asDiagonal()});
    State state = rest_state(model);
    pose(state, 0).p = Vec3(0, 1, 0);
    twist(state, 0) << Vec3(3, 20, -2).cross(Vec3(0, 1, 0)), Vec3(3, 20, -2);
    add(model, joint_at(JointKind::spherical, "tip", 0, kWorld, state.g, SE3{}));
    const double E = energy(model, state).total();
    const PassiveMidpoint scheme(model, exact(h));
    double worst = 0;
    while (state.t < 1 - h / 2) {
      const StepReport report = scheme.step(state);
      EXPECT_TRUE(report.ok());
      EXPECT_NEAR(report.energy.residual(), 0, 1e-12 * E);
      EXPECT_LT(report.joint_error.translation, 1e-13);
      worst = std::max(worst, std::abs(energy(model, state).total() - E));
    }
    return worst;
  };
  const double order = std::log2(lost(2e-3) / lost(1e-3));
  EXPECT_GT(order, 1.9);
}

TEST(PassiveMidpoint, GivesTheSameBitsAfterACopyAndByAFreshScheme) {
  Scene s = block_on_plate(0.3, 0.5, 0.2, 0.01);
  twist(s.state, s.block).tail<3>() = Vec3(3, 2, 1);
  const PassiveMidpoint scheme(s.model, exact(1e-3));
  State state = s.state;
  for (int k = 0; k < 100; ++k) {
    State copy = state;
    ASSERT_TRUE(scheme.step(state).ok());
    ASSERT_TRUE(PassiveMidpoint(s.model, exact(1e-3)).step(copy).ok());
    ASSERT_EQ(hash(state), hash(copy)) << "step " << k;
  }
}

TEST(PassiveMidpoint, RefusesBadOptions) {
  const Model model = free_body(Mat3::Identity());
  EXPECT_NE(message_of([&] { PassiveMidpoint(model, {.h = -1}); }).find("StepOptions::h = -1"),
            std::string::npos);
  EXPECT_EQ(value_named("screw", "update", kGroupUpdates), GroupUpdate::screw);
}

}  // namespace
}  // namespace aussois
