// SPDX-License-Identifier: Apache-2.0
// doc/theory/schatzman_paoli.md: central differences on positions, by hand and by conservation.
#include "integrators/schemes/schatzman_paoli.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// A point of mass 1 on a line with a wall at 0 and a spring of stiffness k.
Model point_and_wall(double restitution, double k = 0) {
  Model model;
  model.gravity.setZero();
  add(model, Coordinates{.name = "point",
                         .size = 1,
                         .mass = [](const VecX&) -> MatX { return MatX::Identity(1, 1); },
                         .force =
                             [k](double, const VecX& q, const VecX&) {
                               return CoordinateForce{.f = -k * q, .K = MatX::Constant(1, 1, k), .C = {}};
                             },
                         .potential = [k](const VecX& q) { return k / 2 * q.squaredNorm(); }});
  add(model, GapFunction{.name = "wall",
                         .block = 0,
                         .evaluate =
                             [](const Model& m, const State& state, double) {
                               return GapRows{
                                   .gap = coordinates(m, state, 0)[0], .J = MatX::Ones(1, 1), .rate = {}};
                             },
                         .law = {.mu = 0, .restitution = restitution}});
  return model;
}

StepOptions with_step(double h) {
  return {.h = h, .solver = {.tolerance = 1e-12}};
}

// From a at speed -V the positions are a, a - hV, ..., and at the wall q_{k+1} = -e q_{k-1} twice; then the
// speed is e V exactly, wherever in its step the impact is.
TEST(SchatzmanPaoli, ReversesOverTwoStepsByItsPositions) {
  const double h = 0.01, V = 1;
  for (const double e : {0.0, 0.3, 1.0})
    for (const double start : {0.031, 0.0345, 0.0399}) {
      const Model model = point_and_wall(e);
      State state = rest_state(model);
      state.q[0] = start;
      state.v[0] = -V;
      const SchatzmanPaoli scheme(model, with_step(h));
      std::vector<double> q{start + h * V, start};  // the recursion of the paper
      for (int k = 0; k < 12; ++k) {
        const StepReport report = scheme.step(state);
        ASSERT_TRUE(report.ok()) << report.reason;
        const double before = q[q.size() - 2], now = q.back();
        q.push_back(std::max(2 * now - before, -e * before));
        EXPECT_NEAR(state.q[0], q.back(), 1e-12) << "step " << k << ", e = " << e;
      }
      EXPECT_NEAR(state.v[0], e * V, 1e-10);
    }
}

// The step is cut while the impact is under way: restitution stays.
TEST(SchatzmanPaoli, KeepsItsRestitutionOverStepsOfOtherLengths) {
  const Model model = point_and_wall(0.5);
  for (const double first : {0.002, 0.004, 0.009})
    for (const double second : {0.004, 0.01}) {
      State state = rest_state(model);
      state.q[0] = 0.008 - 1e-4;
      state.v[0] = -1;
      const SchatzmanPaoli scheme(model, with_step(0.01));
      ASSERT_TRUE(scheme.step(state, 0.007).ok());
      ASSERT_TRUE(scheme.step(state, first).ok());  // closes within it
      ASSERT_TRUE(scheme.step(state, std::max(first, second)).ok());
      ASSERT_TRUE(scheme.step(state, std::max(first, second)).ok());
      EXPECT_NEAR(state.v[0], 0.5, 1e-10) << first << " " << second;
    }
}

// Without a wall: Stoermer-Verlet, whose discrete energy (v^2 + k q_k q_{k-1}) / 2 is an invariant.
TEST(SchatzmanPaoli, IsVerletBetweenImpacts) {
  const double h = 0.05, k = 4;
  const Model model = point_and_wall(0, k);
  State state = rest_state(model);
  state.q[0] = 5;
  state.v[0] = 0;
  Model open = model;
  open.gaps.clear();
  const SchatzmanPaoli scheme(open, with_step(h));
  double before = state.q[0];
  ASSERT_TRUE(scheme.step(state).ok());
  const auto invariant = [&] { return state.v[0] * state.v[0] / 2 + k / 2 * state.q[0] * before; };
  const double first = invariant();
  EXPECT_NEAR(state.q[0], 5 * (1 - k * h * h / 2), 1e-12);  // a start of order two
  for (int i = 0; i < 1000; ++i) {
    before = state.q[0];
    ASSERT_TRUE(scheme.step(state).ok());
    ASSERT_NEAR(invariant(), first, 1e-10);
  }
}

TEST(SchatzmanPaoli, ABlockLandsAndStaysWithoutOverlap) {
  Scene s = block_on_plate(0.6, 0, 0.3, 0.02);  // tan 0.3 = 0.31: it sticks
  const SchatzmanPaoli scheme(s.model, with_step(2e-3));
  double least = kInf, residual = 0;
  Vec3 landed = Vec3::Zero();
  while (s.state.t < 0.6) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    least = std::min(least, report.min_gap);
    residual = std::max(residual, std::abs(report.energy.residual()));
    if (s.state.t < 0.4) landed = pose(s.state, s.block).p;
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_LT(residual, 1e-12);
  EXPECT_LT((pose(s.state, s.block).p - landed).norm(), 1e-9);
  EXPECT_LT(twist(s.state, s.block).norm(), 1e-9);
}

// The penetration that restitution takes, e h V, is more than the certificate allows: steps are cut, nothing
// tunnels, and the block comes back.
TEST(SchatzmanPaoli, BouncesUnderTheCertificate) {
  Scene s = block_on_plate(0, 0.8, 0, 0.02);
  s.model.gravity.setZero();
  twist(s.state, s.block)[2] = -1;
  const SchatzmanPaoli scheme(s.model, with_step(1e-2));
  int cut = 0;
  while (s.state.t < 0.1) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    cut += report.h < 1e-2 * (1 - 1e-9);
  }
  EXPECT_GT(cut, 0);
  EXPECT_NEAR(twist(s.state, s.block)[2], 0.8, 1e-8);
}

TEST(SchatzmanPaoli, HasTheSameBitsFromACopy) {
  const auto hash_after = [](bool fresh) {
    Scene s = block_on_plate(0.3, 0.2, 0.2, 0.01);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    const StepOptions o = with_step(1e-3);
    const SchatzmanPaoli scheme(s.model, o);
    for (int i = 0; i < 100; ++i)
      (void)(fresh ? SchatzmanPaoli(s.model, o).step(s.state) : scheme.step(s.state));
    return hash(s.state);
  };
  EXPECT_EQ(hash_after(true), hash_after(false));
}

TEST(SchatzmanPaoli, RefusesOtherUpdatesAndThetas) {
  const Scene s = block_on_plate(0, 0, 0);
  EXPECT_EQ(message_of([&] { SchatzmanPaoli(s.model, {.update = GroupUpdate::cayley}); }),
            "update = cayley is not read by schatzman_paoli");
  EXPECT_NE(message_of([&] { SchatzmanPaoli(s.model, {}, {.force_theta = -1}); }).find("force_theta"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
