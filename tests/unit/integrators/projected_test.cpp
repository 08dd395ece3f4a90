// SPDX-License-Identifier: Apache-2.0
// doc/theory/moreau_jean_projected.md: nothing overlaps after a step, and what that costs elsewhere.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean_projected.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

double gap_now(const Scene& s) {
  return smallest_gap(MoreauJean(s.model, {}, {.theta = 1}).contacts(s.state, 1e-3));
}

constexpr ProjectionOrder kOrders[] = {ProjectionOrder::direct, ProjectionOrder::combined};

// A tumbling block that bounces and slides to rest: Moreau-Jean's own law leaves overlaps of micrometres, the
// projected one none beyond rounding, and every path is certified.
TEST(MoreauJeanProjected, LeavesNoOverlap) {
  for (const ProjectionOrder order : kOrders) {
    double plain = 0, projected = 0, largest = 0;
    int alone = 0;
    for (const bool project : {false, true}) {
      Scene s = block_on_plate(0.3, 0.4, 0.2, 0.03);
      pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
      twist(s.state, s.block) << 0.5, 0.2, -1, 3, -2, 1;
      const MoreauJean moreau(s.model, {.h = 1e-3}, {.theta = 0.5, .law = NormalLaw::moreau});
      const MoreauJeanProjected scheme(s.model, {.h = 1e-3}, {.order = order});
      for (int k = 0; k < 600; ++k) {
        const StepReport report = project ? scheme.step(s.state) : moreau.step(s.state);
        ASSERT_TRUE(report.ok()) << report.reason;
        ASSERT_LT(std::abs(report.energy.residual()), 1e-13);
        largest = std::max(largest, report.projection);
        if (report.projection > 0 && report.contacts_kept == 0) {  // no other solve than the projection's
          EXPECT_GT(report.solve.iterations, 0);
          ++alone;
        }
        double& deepest = project ? projected : plain;
        deepest = std::max(deepest, -gap_now(s));
      }
    }
    EXPECT_GT(plain, 1e-6) << name_of(order, kProjectionOrders);  // so that there was something to hold
    EXPECT_LT(projected, 1e-12) << name_of(order, kProjectionOrders);
    EXPECT_GT(largest, 1e-6);
    EXPECT_TRUE(alone > 0 || order == ProjectionOrder::combined);
  }
}

// A ball that falls from 5 cm onto the plate reverses by -e exactly, and stands where it touched.
TEST(MoreauJeanProjected, ReversesAtTheWall) {
  for (const ProjectionOrder order : kOrders) {
    Scene s = block_on_plate(0, 0.5, 0, 0.01);
    s.model.gravity.setZero();
    twist(s.state, s.block)[2] = -0.7;
    const MoreauJeanProjected scheme(s.model, {.h = 1e-3}, {.order = order});
    for (int k = 0; k < 40; ++k) ASSERT_TRUE(scheme.step(s.state).ok());
    EXPECT_NEAR(twist(s.state, s.block)[2], 0.35, 1e-10);
  }
}

// What would overlap is given its impulse in the same step by the combined scheme, one step later by the
// direct one.
TEST(MoreauJeanProjected, CombinedActivatesWhatThePositionsAskFor) {
  const auto velocity_after_one_step = [](ProjectionOrder order) {
    Scene s = block_on_plate(0, 0, 0, 7e-4);  // 0.7 of a step's way: Moreau's law looks half a step ahead
    s.model.gravity.setZero();
    twist(s.state, s.block)[2] = -1;
    const StepReport report = MoreauJeanProjected(s.model, {.h = 1e-3}, {.order = order}).step(s.state);
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.h, order == ProjectionOrder::direct ? report.h : 1e-3);
    EXPECT_GT(gap_now(s), -1e-12);
    return twist(s.state, s.block)[2];
  };
  EXPECT_NEAR(velocity_after_one_step(ProjectionOrder::combined), 0, 1e-10);
  EXPECT_NEAR(velocity_after_one_step(ProjectionOrder::direct), -1, 1e-12);
}

// Coordinates with a gap function, and a hinge: both hold at once.
TEST(MoreauJeanProjected, HoldsGapFunctionsAndJoints) {
  Model model;
  model.contact_law = {.mu = 0.2, .restitution = 0.3};
  const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
  const auto plate = add(model, prepare(dilate(make_plate(2, 2), 1e-3)));
  add(model, RigidBody{.name = "ball", .shape = ball, .mass = 1, .inertia = 1e-3 * Mat3::Identity()});
  add(model, fixed_body("floor", plate));
  add(model, Coordinates{.name = "point",
                         .size = 1,
                         .mass = [](const VecX&) -> MatX { return MatX::Identity(1, 1); },
                         .force =
                             [](double, const VecX&, const VecX&) {
                               return CoordinateForce{.f = VecX::Constant(1, -9.81), .K = {}, .C = {}};
                             },
                         .potential = {}});
  add(model, GapFunction{.name = "floor",
                         .block = 0,
                         .evaluate =
                             [](const Model& m, const State& state, double) {
                               const double q = coordinates(m, state, 0)[0];  // curved: gap = q + q^2
                               return GapRows{
                                   .gap = q + q * q, .J = MatX::Constant(1, 1, 1 + 2 * q), .rate = {}};
                             },
                         .law = {.mu = 0, .restitution = 0.6}});
  for (const ProjectionOrder order : kOrders) {
    State state = rest_state(model);
    pose(state, 0).p = Vec3(0.3, 0, 0.13);
    state.q[0] = 0.1;
    Model hinged = model;
    add(hinged, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g,
                         translation(0, 0, 0.051) * rotation(Vec3::UnitX(), -kPi / 2)));
    const MoreauJeanProjected scheme(hinged, {.h = 2e-3}, {.order = order});
    double deepest = 0, joint = 0, q_least = 0;
    int projections = 0;
    for (int k = 0; k < 300; ++k) {
      const StepReport report = scheme.step(state);
      ASSERT_TRUE(report.ok()) << report.reason;
      projections += report.projection > 0;
      q_least = std::min(q_least, state.q[0] + state.q[0] * state.q[0]);
      joint = std::max({joint, report.joint_error.translation, report.joint_error.rotation});
      deepest = std::max(deepest, -smallest_gap(MoreauJean(hinged, {}, {.theta = 1}).contacts(state, 1e-3)));
      ASSERT_LT(std::abs(report.energy.residual()), 1e-13);
    }
    EXPECT_GT(projections, 1);
    EXPECT_GT(q_least, -1e-12);
    EXPECT_LT(deepest, 1e-11);
    EXPECT_LT(joint, 1e-12);
  }
}

TEST(MoreauJeanProjected, HasTheSameBitsFromACopyAndForAnyNumberOfThreads) {
  const auto hash_after = [](int threads, bool fresh) {
    Scene s = block_on_plate(0.3, 0.2, 0.2, 0.01);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    const StepOptions o{.h = 2e-3, .threads = threads};
    const MoreauJeanProjected scheme(s.model, o);
    for (int i = 0; i < 100; ++i)
      (void)(fresh ? MoreauJeanProjected(s.model, o).step(s.state) : scheme.step(s.state));
    return hash(s.state);
  };
  const std::uint64_t reference = hash_after(1, false);
  EXPECT_EQ(hash_after(2, false), reference);
  EXPECT_EQ(hash_after(1, true), reference);
}

TEST(MoreauJeanProjected, RefusesOtherThetas) {
  const Scene s = block_on_plate(0, 0, 0);
  EXPECT_NE(message_of([&] { MoreauJeanProjected(s.model, {}, {.theta = 0.2}); }).find("theta"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
