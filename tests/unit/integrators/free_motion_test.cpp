// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/free_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

Model free_body(const Mat3& inertia, double mass = 2) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, RigidBody{.name = "body", .mass = mass, .inertia = inertia});
  return model;
}

// Position after one second of a mass on a linear spring, released at 1 m: cos(omega t).
double spring_error(double h, double theta) {
  Model model = free_body(Mat3::Identity(), 1);
  const double k = 9;
  add(model, ForceLaw{.name = "spring",
                      .add_to =
                          [k](const Model&, const State& s, double, GeneralisedForce& out) {
                            out.f[0] -= k * s.g[0].p.x();
                            out.K.emplace_back(0, 0, k);
                          },
                      .potential = {}});
  State state = rest_state(model);
  pose(state, 0).p.x() = 1;
  const MoreauJean scheme(model, {.h = h}, {.theta = theta});
  while (state.t < 1 - h / 2) EXPECT_EQ(scheme.step(state, 1 - state.t).status, StepStatus::ok);
  return std::abs(pose(state, 0).p.x() - std::cos(3.0));
}

TEST(FreeMotion, IsOfOrderOneAtThetaOneAndTwoAtThetaOneHalf) {
  const auto order = [](double theta) {
    return std::log(spring_error(1.0 / 40, theta) / spring_error(1.0 / 640, theta)) / std::log(16.0);
  };
  EXPECT_GT(order(1.0), 0.95);
  EXPECT_LT(order(1.0), 1.3);
  EXPECT_GT(order(0.5), 1.95);
}

TEST(FreeMotion, FallsAsTheThetaSchemeSays) {
  Model model = free_body(Mat3::Identity());
  model.gravity = {0, 0, -10};
  State state = rest_state(model);
  const MoreauJean scheme(model, {.h = 0.01}, {.theta = 0.5});
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(scheme.step(state).ok());
  EXPECT_NEAR(twist(state, 0)[2], -10, 1e-12);
  EXPECT_NEAR(pose(state, 0).p.z(), -5, 1e-12);  // exact for a constant force
}

// A torque-free top: spatial angular momentum and energy are kept, to the order of the scheme.
TEST(FreeMotion, OfATopKeepsItsAngularMomentumToSecondOrder) {
  const auto drift = [](double h) {
    const Mat3 J = Vec3(1, 2, 3).asDiagonal();
    const Model model = free_body(J);
    State state = rest_state(model);
    twist(state, 0).tail<3>() = Vec3(0.3, 2, 0.4);
    const auto spatial = [&] { return Vec3(pose(state, 0).R * (J * twist(state, 0).tail<3>())); };
    const Vec3 before = spatial();
    const MoreauJean scheme(model, {.h = h}, {.theta = 0.5});
    while (state.t < 1 - h / 2) EXPECT_TRUE(scheme.step(state, 1 - state.t).ok());
    return (spatial() - before).norm();
  };
  EXPECT_LT(drift(1e-2), 1e-2);
  EXPECT_GT(std::log2(drift(1e-2) / drift(5e-3)), 1.9);
}

}  // namespace
}  // namespace aussois
