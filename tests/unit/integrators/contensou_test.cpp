// SPDX-License-Identifier: Apache-2.0
// Coulomb-Contensou friction of a pair: a disc that slides and spins (verification case B4, ellipsoid law).
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

constexpr double kMass = 1, kDisc = 0.1, kMu = 0.3, kArm = 2 * kDisc / 3;  // R_e of uniform pressure [m]
constexpr double kSpin = 0.5 * kMass * kDisc * kDisc;                      // moment of inertia [kg m^2]

// The disc touches in one point at its centre of mass, so it cannot tip.
struct Disc {
  Model model{};
  State state{};
  explicit Disc(double v, double w) {
    model.contact_law = {.mu = kMu, .contensou_radius = kArm};
    const auto plate = add(model, prepare(dilate(make_plate(6, 6), kRadius)));
    const auto foot = add(model, prepare(dilate(make_point(), 5e-3)));
    add(model, fixed_body("ground", plate));
    add(model, RigidBody{.name = "disc",
                         .shape = foot,
                         .g_bs = translation(0, 0, 5e-3),
                         .mass = kMass,
                         .inertia = Vec3(kSpin / 2, kSpin / 2, kSpin).asDiagonal()});
    state = rest_state(model);
    state.g[1].p.z() = kRadius;
    state.v[6] = v, state.v[11] = w;
  }
};

// v' = -mu g v / s, J w' = -mu m g R_e^2 w / s, s^2 = v^2 + R_e^2 w^2: Runge-Kutta until it stops.
struct Motion2 {
  double t = 0, x = 0, v = 0, w = 0;
};
Motion2 reference(double v, double w, double t_end) {
  const auto rate = [](const Vec3& y) -> Vec3 {
    const double s = std::hypot(y[1], kArm * y[2]), N = kMass * kGravity;
    return {y[1], -kMu * N / kMass * y[1] / s, -kMu * N * kArm * kArm / kSpin * y[2] / s};
  };
  Vec3 y(0, v, w);
  double t = 0;
  const double dt = 1e-5;
  while (t < t_end && std::hypot(y[1], kArm * y[2]) > kMu * kGravity * 2 * dt) {
    const Vec3 a = rate(y), b = rate(y + dt / 2 * a), c = rate(y + dt / 2 * b), d = rate(y + dt * c);
    y += dt / 6 * (a + 2 * b + 2 * c + d);
    t += dt;
  }
  return {t, y[0], y[1], y[2]};
}

TEST(ContensouDisc, SlidesAndSpinsAsItsEquationsSayAndStopsInOneInstant) {
  for (const auto& [v, w] : {std::pair{1.0, 10.0}, {1.0, 30.0}, {1.0, 2.0}}) {
    const Motion2 stop = reference(v, w, kInf), half = reference(v, w, 0.2);
    const double h = 1e-3;
    Disc disc(v, w);
    const MoreauJean scheme(disc.model, {.h = h, .solver = {.tolerance = 1e-11}}, {.theta = 0.5});
    run(scheme, disc.state, 0.2);
    EXPECT_NEAR(disc.state.v[6], half.v, 2 * h) << v << ' ' << w;
    EXPECT_NEAR(disc.state.v[11], half.w, 20 * h) << v << ' ' << w;
    EXPECT_LT(disc.state.v.segment<2>(9).norm(), 1e-9);  // upright
    run(scheme, disc.state, stop.t - 2 * h);
    EXPECT_GT(disc.state.v.norm(), 1e-3);
    run(scheme, disc.state, stop.t + 2 * h);
    EXPECT_LT(disc.state.v.norm(), 1e-6);
    EXPECT_NEAR(disc.state.g[1].p.x(), stop.x, 2 * h);
  }
}

TEST(ContensouDisc, ErrsByOrderOne) {
  const Motion2 exact = reference(1, 10, 0.3);
  const auto error = [&](double h) {
    Disc disc(1, 10);
    run(MoreauJean(disc.model, {.h = h, .solver = {.tolerance = 1e-11}}, {.theta = 1}), disc.state, 0.3);
    return std::abs(disc.state.v[6] - exact.v) + kDisc * std::abs(disc.state.v[11] - exact.w);
  };
  EXPECT_NEAR(std::log(error(7e-3) / error(2e-3)) / std::log(3.5), 1, 0.15);
}

TEST(ContensouDisc, RemembersItsDrillingImpulse) {
  Disc disc(0.1, 30);
  const MoreauJean scheme(disc.model, {.h = 1e-3}, {.theta = 1});
  const StepReport first = scheme.step(disc.state);
  ASSERT_EQ(first.contacts.size(), 1U);
  ASSERT_EQ(disc.state.memory.contacts.size(), 1U);
  EXPECT_EQ(disc.state.memory.contacts[0].drilling, first.contacts[0].drilling);
  // almost pure spin: all friction drills; it takes A, the ground, along, whose normal points down
  const double most = kMu * kMass * kGravity * kArm * first.h;
  EXPECT_NEAR(first.contacts[0].drilling, -most, 2e-3 * most);
  EXPECT_EQ(first.contacts[0].point.a.body, BodyId(0));
  State other = disc.state;
  other.memory.contacts[0].drilling = 0;
  EXPECT_NE(hash(other), hash(disc.state));
}

TEST(ContensouDisc, WithoutRadiusSpinsForEver) {
  Disc disc(0, 30);
  disc.model.contact_law.contensou_radius = 0;
  run(MoreauJean(disc.model, {.h = 1e-2}, {.theta = 1}), disc.state, 1);
  EXPECT_NEAR(disc.state.v[11], 30, 1e-9);
}

}  // namespace
}  // namespace aussois
