// SPDX-License-Identifier: Apache-2.0
// doc/theory/generalised_coordinates.md: models of one's own in the same scheme.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/point_and_wall.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kG = 9.81;

double order(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

TEST(BouncingBall, OnACoordinateKeepsItsEnergyWhenElasticAndRestsWhenPlastic) {
  const Model elastic = point_and_wall(0, -kG, 0, 1);
  State state = rest_state(elastic);
  state.q[0] = 1;
  const double E = energy(elastic, state).total();
  EXPECT_NEAR(E, kG, 1e-14);
  // at theta = 1/2 the flight is exact and the impact step reverses v; it moves by (v - v) / 2 = 0
  advance(MoreauJean(elastic, {.h = 1.3e-3}, {.theta = 0.5, .law = NormalLaw::moreau}), state, 5,
          [&](const StepReport& report) {
            if (!report.gaps.empty()) return;  // within the step of an impact q stands still
            EXPECT_NEAR(energy(elastic, state).total(), E, 1e-10);
          });
  const Model plastic = point_and_wall(0, -kG, 0, 0);
  state = rest_state(plastic);
  state.q[0] = 1;
  double least = kInf, push = 0;
  advance(MoreauJean(plastic, {.h = 7e-3}, {.theta = 1}), state, 1, [&](const StepReport& report) {
    least = std::min(least, report.min_gap);
    push = report.gaps[0].impulse.x() / report.h;
  });
  EXPECT_GT(least, -1e-15);
  EXPECT_NEAR(state.q[0], 0, 1e-12);
  EXPECT_NEAR(push, kG, 1e-10);
}

// Two rods of one kilogram and metre, hinged, angles from the horizontal: Lagrange's equations.
Coordinates double_pendulum() {
  const auto mass = [](const VecX& q) -> MatX {
    const double c = std::cos(q[0] - q[1]) / 2;
    MatX M(2, 2);
    M << 4.0 / 3, c, c, 1.0 / 3;
    return M;
  };
  const auto force = [](double, const VecX& q, const VecX& v) {
    const double s = std::sin(q[0] - q[1]) / 2;
    CoordinateForce out{.f = VecX(2), .C = MatX(2, 2)};
    out.f << -s * v[1] * v[1] - 1.5 * kG * std::cos(q[0]), s * v[0] * v[0] - 0.5 * kG * std::cos(q[1]);
    out.C << 0, 2 * s * v[1], -2 * s * v[0], 0;
    return out;
  };
  return {.name = "double pendulum", .size = 2, .mass = mass, .force = force, .potential = [](const VecX& q) {
            return kG * (1.5 * std::sin(q[0]) + 0.5 * std::sin(q[1]));
          }};
}

TEST(GeneralisedCoordinates, GiveTheDoublePendulumThatBodiesWithJointsGive) {
  const auto angles = [](double h, bool of_bodies) -> Vec2 {
    Model model;
    if (of_bodies) {
      const Mat3 J = Vec3(0.001, 1.0 / 12, 1.0 / 12).asDiagonal();
      for (int i = 0; i < 2; ++i) add(model, RigidBody{.name = "rod", .mass = 1, .inertia = J});
    } else {
      add(model, double_pendulum());
    }
    State state = rest_state(model);
    if (of_bodies)
      for (int i = 0; i < 2; ++i) {
        state.g[BodyId::at(i)].p.x() =
            0.5 + i;  // rotations about -y raise the end: angles from the horizontal
        add(model, joint_at(JointKind::revolute, "hinge", BodyId::at(i), BodyId::at(-1 + i), state.g,
                            translation(i, 0, 0) * rotation(Vec3::UnitX(), kPi / 2)));
      }
    const double E = energy(model, state).total();
    advance(MoreauJean(model, {.h = h}, {.theta = 0.5}), state, 1, [&](const StepReport& report) {
      EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
      EXPECT_LT(std::abs(energy(model, state).total() - E), 200 * h * h);
    });
    if (!of_bodies) return state.q;
    const double first = joint_coordinate(model, state, 0);
    return Vec2(first, first + joint_coordinate(model, state, 1));
  };
  const Vec2 reference = angles(2.5e-4, false);
  for (const bool of_bodies : {false, true}) {
    const double coarse = (angles(7e-3, of_bodies) - reference).norm(),
                 fine = (angles(2e-3, of_bodies) - reference).norm();
    EXPECT_LT(fine, 2e-3);
    EXPECT_NEAR(order(coarse, fine, 3.5), 2, 0.3) << of_bodies;
  }
}

// A block on a belt that runs at 1 m/s: friction carries it up to the belt's speed, then holds it there.
TEST(GeneralisedCoordinates, FeelFrictionOfAMovingBelt) {
  Model model;
  add(model, Coordinates{.name = "block",
                         .size = 2,
                         .mass = [](const VecX&) -> MatX { return 2 * MatX::Identity(2, 2); },
                         .force = [](double, const VecX&,
                                     const VecX&) { return CoordinateForce{.f = Vec2(0, -2 * kG)}; }});
  add(model, GapFunction{.name = "belt",
                         .block = 0,
                         .evaluate =
                             [](const Model&, const State& state, double) {
                               GapRows rows{.gap = state.q[1], .J = MatX::Zero(2, 2), .rate = Vec2(0, -1)};
                               rows.J(0, 1) = rows.J(1, 0) = 1;
                               return rows;
                             },
                         .law = {.mu = 0.2}});
  State state = rest_state(model);
  const MoreauJean scheme(model, {.h = 1e-2}, {.theta = 1});
  advance(scheme, state, 0.5);
  EXPECT_NEAR(state.v[0], 0.2 * kG * 0.5, 1e-7);
  advance(scheme, state, 0.6);  // at 0.51 s it has the belt's speed
  EXPECT_NEAR(state.v[0], 1, 1e-7);
  EXPECT_NEAR(state.q[1], 0, 1e-9);
}

// A wall that comes: the explicit time of a gap function.
TEST(GeneralisedCoordinates, ArePushedByAWallThatMoves) {
  Model model = point_and_wall(0, 0, 0, 0);
  model.gaps[0].evaluate = [](const Model&, const State& state, double t) {
    return GapRows{.gap = state.q[0] - (t - 0.5), .J = MatX::Ones(1, 1), .rate = VecX::Constant(1, -1)};
  };
  State state = rest_state(model);
  const MoreauJean scheme(model, {.h = 1e-2}, {.theta = 1});
  advance(scheme, state, 0.45);
  EXPECT_EQ(state.v[0], 0);
  advance(scheme, state, 1);
  EXPECT_NEAR(state.v[0], 1, 1e-12);
  EXPECT_NEAR(state.q[0], 0.5, 1e-12);
}

// Coordinates and a body in one gap function: a piston (coordinate, mass 3) hits a body (mass 1) along x.
TEST(GeneralisedCoordinates, CanTouchABody) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, RigidBody{.name = "ball", .mass = 1, .inertia = Mat3::Identity()});
  add(model, Coordinates{.name = "piston", .size = 1, .mass = [](const VecX&) -> MatX {
                           return MatX::Constant(1, 1, 3);
                         }});
  add(model, GapFunction{.name = "face",
                         .evaluate =
                             [](const Model&, const State& state, double) {
                               GapRows rows{.gap = state.g[0].p.x() - state.q[0], .J = MatX::Zero(1, 7)};
                               rows.J(0, 0) = 1, rows.J(0, 6) = -1;
                               return rows;
                             },
                         .law = {.mu = 0, .restitution = 0.5}});
  State state = rest_state(model);
  state.g[0].p.x() = 0.1;
  state.v[6] = 1;
  advance(MoreauJean(model, {.h = 1e-3}, {.theta = 1}), state, 0.2);
  EXPECT_NEAR(state.v[6], 1 - 1.5 / 4, 1e-12);
  EXPECT_NEAR(state.v[0], 1.5 * 3 / 4, 1e-12);
  EXPECT_NEAR(momentum(model, state).linear.x() + 3 * state.v[6], 3, 1e-13);
}

TEST(GeneralisedCoordinates, GoOnFromACopyWithTheSameBits) {
  const Model model = point_and_wall(1, 0.3, -0.5, 0.8);
  State state = rest_state(model);
  state.q[0] = 1;
  const MoreauJean scheme(model, {.h = 3e-3}, {.theta = 1});
  advance(scheme, state, 3);
  State copy = state;
  advance(scheme, state, 6);
  advance(MoreauJean(model, {.h = 3e-3}, {.theta = 1}), copy, 6);
  EXPECT_EQ(hash(state), hash(copy));
  EXPECT_EQ(message_of([&] { validate(model, state); }), "");
  copy.r.resize(2);
  EXPECT_NE(message_of([&] { validate(model, copy); }).find("size of State::r = 2"), std::string::npos);
  copy = state;
  copy.q.resize(0);
  EXPECT_NE(message_of([&] { validate(model, copy); }).find("size of State::q = 0 must be"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
