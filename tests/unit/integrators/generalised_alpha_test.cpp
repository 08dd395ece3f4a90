// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/generalised_alpha.hpp"

#include "integrators/run.hpp"
#include "mechanics/joint.hpp"
#include "mechanics/mechanism.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// A mass on a spring, both 1 but for the stiffness, released at 1 m.
struct Spring {
  Model model{};
  State state{};
  explicit Spring(double k) {
    model.gravity = Vec3::Zero();
    add(model, RigidBody{.name = "mass", .mass = 1, .inertia = Mat3::Identity()});
    model.forces.push_back({.name = "spring",
                            .add_to =
                                [k](const Model&, const State& s, double, GeneralisedForce& force) {
                                  force.f[0] -= k * s.g[0].p.x();
                                  force.K.emplace_back(0, 0, k);
                                },
                            .potential = [k](const Model&, const State& s,
                                             double) { return k / 2 * s.g[0].p.x() * s.g[0].p.x(); }});
    state = rest_state(model);
    pose(state, 0).p.x() = 1;
  }
};

// What moves a million times faster than the step shrinks by the spectral radius per step. The eigenvalue is
// double: after n steps the factor between them is rho (1 + 1/n) at most.
TEST(GeneralisedAlpha, DampsStiffMotionsByItsSpectralRadius) {
  for (const double rho : {0.2, 0.5, 0.8}) {
    Spring s(1e12);
    const GeneralisedAlpha scheme(s.model, {.h = 1}, {.spectral_radius = rho});
    const auto size = [&] { return std::abs(pose(s.state, 0).p.x()) + std::abs(twist(s.state, 0)[0]); };
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(scheme.step(s.state).ok());
    const double before = size();
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(scheme.step(s.state).ok());
    EXPECT_NEAR(std::pow(size() / before, 0.1), rho, 0.12 * rho);
  }
}

// The numerical work is zero for rho = 1 and takes energy for less: what poses and velocities have lost, but
// for what the works of the spring's force and its potential differ by, of order two.
TEST(GeneralisedAlpha, TellsWhatItDamps) {
  for (const double rho : {0.5, 1.0}) {
    Spring s(400);
    const double E = energy(s.model, s.state).total();
    const GeneralisedAlpha scheme(s.model, {.h = 2e-2}, {.spectral_radius = rho});
    double numerical = 0;
    for (int k = 0; k < 200; ++k) {
      const StepReport report = scheme.step(s.state);
      ASSERT_TRUE(report.ok());
      numerical += report.energy.numerical_work;
    }
    if (rho == 1)
      EXPECT_NEAR(numerical, 0, 1e-12 * E);
    else
      EXPECT_LT(numerical, -0.1 * E);
    EXPECT_LT(energy(s.model, s.state).total(), (rho == 1 ? 1.2 : 0.9) * E);
  }
  const auto unexplained = [](double h) {
    Spring s(400);
    const GeneralisedAlpha scheme(s.model, {.h = h}, {.spectral_radius = 0.5});
    double lost = energy(s.model, s.state).total();
    while (s.state.t < 0.4 - h / 2) lost += scheme.step(s.state).energy.numerical_work;
    return std::abs(lost - s.state.v.squaredNorm() / 2 - 200 * s.state.g[0].p.squaredNorm());
  };
  EXPECT_GT(std::log2(unexplained(4e-3) / unexplained(2e-3)), 1.9);
}

// A block lands flat: from the step of the impact on the gap is zero and so is the speed.
TEST(GeneralisedAlpha, LandsAtBothLevels) {
  Scene s = block_on_plate(0.3, 0, 0, 0.02);
  const GeneralisedAlpha scheme(s.model, {.h = 3e-3});
  bool landed = false;
  for (int k = 0; k < 60; ++k) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok());
    EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
    const double gap = pose(s.state, s.block).p.z() - kSide / 2 - 2 * kRadius;
    EXPECT_GT(gap, -1e-12);
    landed = landed || gap < 1e-9;
    if (landed) {
      EXPECT_NEAR(gap, 0, 1e-11);
      EXPECT_LT(twist(s.state, s.block).norm(), 1e-9);
    }
  }
  EXPECT_TRUE(landed);
}

// It comes back with e, and the ledger knows where the rest is.
TEST(GeneralisedAlpha, BouncesByNewtonsLaw) {
  Scene s = block_on_plate(0, 0.6, 0, 0.02);
  const GeneralisedAlpha scheme(s.model, {.h = 1e-3});
  double before = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok());
    EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
    const double now = twist(s.state, s.block)[2];
    if (now > 0) {
      EXPECT_NEAR(now, -0.6 * before, 1e-9);  // of the speed at the start of that step
      return;
    }
    before = now;
  }
  FAIL() << "it never came back";
}

// Without (GA-8): h / 2 g sin(slope), 1 mm in this second.
TEST(GeneralisedAlpha, LetsNoBlockCreep) {
  Scene s = block_on_plate(0.5, 0, 0.2);
  const Vec3 start = pose(s.state, s.block).p;
  const GeneralisedAlpha scheme(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-11}});
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(scheme.step(s.state).ok());
  EXPECT_LT((pose(s.state, s.block).p - start).norm(), 1e-9);
}

// A rod that turns about its hinge: positions and velocities hold, and the hinge pulls with m omega^2 r.
TEST(GeneralisedAlpha, HoldsJointsAtBothLevelsAndTellsTheirForce) {
  const auto error = [](double h) {
    Model model;
    model.gravity = Vec3::Zero();
    add(model, RigidBody{.name = "rod", .mass = 2, .inertia = Vec3(0.2, 0.01, 0.2).asDiagonal()});
    State state = rest_state(model);
    pose(state, 0).p = Vec3(0, 1, 0);
    twist(state, 0) << Vec3(0, 0, 3).cross(Vec3(0, 1, 0)), Vec3(0, 0, 3);
    add(model, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g, SE3{}));
    const GeneralisedAlpha scheme(model, {.h = h});
    StepReport report;
    while (state.t < 1 - h / 2) {
      report = scheme.step(state);
      EXPECT_TRUE(report.ok());
      EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
      EXPECT_LT(report.joint_error.translation, 1e-13);
      EXPECT_LT((consistent_velocity(model, state) - state.v).norm(), 1e-12);
    }
    return std::abs(report.joints[0].force.norm() - 2 * 9 * 1);
  };
  EXPECT_LT(error(1e-2), 18 * 3e-2 * 3e-2);  // m omega^2 r (omega h)^2
  EXPECT_GT(std::log2(error(2e-2) / error(1e-2)), 1.8);
}

// z'' = -z - 1/2 z' above a stop at -1/2, as a coordinate with a gap function: energy after the impact.
TEST(GeneralisedAlpha, StepsCoordinatesAndGapFunctions) {
  Model model;
  add(model, Coordinates{.name = "z",
                         .size = 1,
                         .mass = [](const VecX&) { return MatX::Identity(1, 1); },
                         .force =
                             [](double, const VecX& q, const VecX&) {
                               return CoordinateForce{.f = -q, .K = MatX::Identity(1, 1), .C = {}};
                             },
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
  const GeneralisedAlpha scheme(model, {.h = 1e-3}, {.spectral_radius = 1});
  while (state.t < 3) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok());
    EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
    EXPECT_GT(state.q[0], -0.5 - 1e-12);
  }
  const double after = 0.5 * 0.64 * 0.75 + 0.125;  // v^2 = 3/4 before the impact at z = -1/2
  EXPECT_NEAR(energy(model, state).total(), after, 2e-3);
}

// The problem of the mean velocity asks nothing of friction: of a gap function too it takes the normal only.
TEST(GeneralisedAlpha, SlidesOnAGapFunctionUntilFrictionStopsIt) {
  constexpr double kMu = 0.2, kG = 9.81;
  Model model;
  add(model, Coordinates{.name = "block",
                         .size = 2,
                         .mass = [](const VecX&) -> MatX { return 2 * MatX::Identity(2, 2); },
                         .force = [](double, const VecX&,
                                     const VecX&) { return CoordinateForce{.f = Vec2(0, -2 * kG)}; },
                         .potential = [](const VecX& q) { return 2 * kG * q[1]; }});
  add(model, GapFunction{.name = "floor",
                         .block = 0,
                         .evaluate =
                             [](const Model&, const State& state, double) {
                               GapRows rows{.gap = state.q[1], .J = MatX::Zero(2, 2), .rate = {}};
                               rows.J(0, 1) = rows.J(1, 0) = 1;
                               return rows;
                             },
                         .law = {.mu = kMu}});
  State state = rest_state(model);
  state.v[0] = 1;
  const GeneralisedAlpha scheme(model, {.h = 1e-2, .solver = {.tolerance = 1e-12}});
  const double stop = 1 / (kMu * kG);
  while (state.t < 0.7) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
    if (std::abs(state.t - stop) > 1e-2) {
      EXPECT_NEAR(state.v[0], std::max(0.0, 1 - kMu * kG * state.t), 1e-10) << "t = " << state.t;
    }
  }
  EXPECT_NEAR(state.q[0], stop / 2, 1e-4);  // off by the step of the stop, mu g h^2 / 8 at most
  EXPECT_NEAR(state.q[1], 0, 1e-12);
}

TEST(GeneralisedAlpha, KeepsAllItRemembersInTheState) {
  Scene s = block_on_plate(0.3, 0.5, 0.2, 0.01);
  twist(s.state, s.block).tail<3>() = Vec3(3, 2, 1);
  const StepOptions step{.h = 1e-3};
  const GeneralisedAlphaOptions own{.spectral_radius = 0.7};
  const GeneralisedAlpha scheme(s.model, step, own);
  State state = s.state;
  for (int k = 0; k < 100; ++k) {
    State copy = state;
    ASSERT_TRUE(scheme.step(state).ok());
    ASSERT_TRUE(GeneralisedAlpha(s.model, step, own).step(copy).ok());
    ASSERT_EQ(hash(state), hash(copy)) << "step " << k;
  }
  EXPECT_EQ(state.a.size(), 2 * state.v.size());
  ASSERT_TRUE(MoreauJean(s.model, {}).step(state).ok());
  EXPECT_EQ(state.a.size(), 0);  // another scheme forgets
}

TEST(GeneralisedAlpha, RefusesBadOptions) {
  const Spring s(1);
  for (const double rho : {-0.1, 1.1, std::nan("")})
    EXPECT_NE(
        message_of([&] { GeneralisedAlpha(s.model, {}, {.spectral_radius = rho}); }).find("spectral_radius"),
        std::string::npos);
}

}  // namespace
}  // namespace aussois
