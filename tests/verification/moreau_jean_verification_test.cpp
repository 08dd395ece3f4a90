// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean scheme against exact solutions.
#include <gtest/gtest.h>

#include "integrators/pose/contact_problem.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

TEST(Incline, ABlockBelowTheFrictionAngleDoesNotCreep) {
  Scene s = block_on_plate(0.5, 0, std::atan(0.45));
  const Vec3 start = pose(s.state, s.block).p;
  const MoreauJean scheme(s.model, {.h = 5e-3, .solver = {.tolerance = 1e-10}}, {.theta = 1});
  run(scheme, s.state, 10);
  EXPECT_LT((pose(s.state, s.block).p - start).norm(), 1e-10);
}

TEST(Incline, ABlockAboveTheFrictionAngleSlidesAsCoulombSays) {
  const double slope = 30 * kPi / 180, mu = 0.5;
  Scene s = block_on_plate(mu, 0, slope);
  const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
  run(scheme, s.state, 0.5);
  const double a = kGravity * (std::sin(slope) - mu * std::cos(slope));
  EXPECT_NEAR(twist(s.state, s.block)[0], a * 0.5, 1e-6);
}

// The gap at the end of the step is closed exactly, whatever the law is called where nothing bounces.
TEST(PlasticLaw, LetsABlockLandOnTheSurface) {
  for (const NormalLaw law : {NormalLaw::gap_over_step, NormalLaw::combined}) {
    Scene s = block_on_plate(0.3, 0, 0, 0.05);
    run(MoreauJean(s.model, {.h = 1e-2}, {.theta = 1, .law = law}), s.state, 0.3);
    EXPECT_NEAR(pose(s.state, s.block).p.z(), kSide / 2 + 2 * kRadius, 1e-8) << to_string(law);
  }
}

// Moreau's law acts on velocities alone: what the block sinks in while it lands stays, at most half a step of
// motion.
TEST(PlasticLaw, OfMoreauKeepsTheOverlapOfTheImpactStep) {
  Scene s = block_on_plate(0.3, 0, 0, 0.05);
  run(MoreauJean(s.model, {.h = 1e-4}, {.theta = 1, .law = NormalLaw::moreau}), s.state, 0.3);
  EXPECT_NEAR(pose(s.state, s.block).p.z(), kSide / 2 + 2 * kRadius, 1e-4);
  EXPECT_LT(twist(s.state, s.block).norm(), 1e-7);
}

// Steps in which one of the block's four corners was let go of, on its way up a slope and at rest there.
int steps_with_a_corner_free(const SchemeOptions& options, double t_end) {
  Scene s = block_on_plate(0.5, 0, 20 * kPi / 180);
  twist(s.state, s.block)[0] = -2;
  const MoreauJean scheme(s.model, options.step, options.moreau_jean);
  int out = 0;
  while (s.state.t < t_end - 1e-12) {
    const StepReport report = scheme.step(s.state, t_end - s.state.t);
    EXPECT_TRUE(report.ok()) << report.reason << " at t = " << s.state.t;
    int corners = 0;
    for (const StepContact& c : report.contacts) corners += !c.impulse.isZero(0);
    out += corners < 4;
  }
  return out;
}

// Without `touching`, gaps of the size of rounding and of the solver's tolerance open contacts for single
// steps.
TEST(MoreauActivation, HoldsABlockThatSlidesOrRestsByAllItsCorners) {
  for (const ContactsAt contacts : {ContactsAt::start, ContactsAt::midpoint})
    for (const double h : {1e-2, 1e-3}) {
      SchemeOptions options{.step = {.h = h, .advancement = {.certify = false}},
                            .moreau_jean = {.theta = 0.5, .law = NormalLaw::moreau, .contacts = contacts}};
      EXPECT_EQ(steps_with_a_corner_free(options, 1), 0) << name_of(contacts, kContactsAt) << ", h = " << h;
      options.step.touching = 0;
      EXPECT_GT(steps_with_a_corner_free(options, 1), 0) << name_of(contacts, kContactsAt) << ", h = " << h;
    }
}

// The predicted gap, and nothing else, decides; what leaves is let go of.
TEST(MoreauActivation, IsThatOfThePredictedGap) {
  const double h = 1e-3, e = 0.8;
  const NormalRule options{.law = NormalLaw::moreau};
  const double touching = options.touching;
  EXPECT_TRUE(normal_bias(touching, 0, e, h, options).active);
  EXPECT_FALSE(normal_bias(1.001 * touching, 0, e, h, options).active);
  EXPECT_TRUE(normal_bias(h / 2 * 3, -3, e, h, options).active);
  EXPECT_FALSE(normal_bias(h / 2 * 3.001, -3, e, h, options).active);
  EXPECT_FALSE(normal_bias(touching, 1e-3, e, h, options).active);
  EXPECT_FALSE(normal_bias(touching, 0, e, h / 10, options).active) << "a hundred times less in a tenth of h";
  EXPECT_TRUE(normal_bias(touching / 100, 0, e, h / 10, options).active);
  EXPECT_DOUBLE_EQ(normal_bias(0, -3, e, h, options).w, -2.4);
  EXPECT_FALSE(normal_bias(0, 3, e, h, options).active);
  EXPECT_DOUBLE_EQ(normal_bias(-1, 3, e, h, options).w, 2.4);  // overlapped, it opens, and may be hit back
}

// A plate that rises at 0.1 m/s lifts the block: same speed, force m g, gap closed.
TEST(PrescribedBody, LiftsABlockWithItsWeight) {
  Scene s = block_on_plate(0.3, 0, 0);
  s.model.bodies[s.ground].motion =
      PrescribedMotion{.path = {.t = {0, 10}, .pose = {SE3{}, translation(0, 0, 1)}}};
  s.state = rest_state(s.model);
  pose(s.state, s.block).p.z() = kSide / 2 + 2 * kRadius;
  const StepReport report =
      run(MoreauJean(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-12}}, {.theta = 1}), s.state, 0.5);
  EXPECT_NEAR(pose(s.state, s.block).p.z(), kSide / 2 + 2 * kRadius + 0.05, 1e-8);
  EXPECT_NEAR(twist(s.state, s.block)[2], 0.1, 1e-9);
  double push = 0;
  for (const StepContact& c : report.contacts) push -= c.impulse.z() / report.h;
  EXPECT_NEAR(push, kDensity * std::pow(kSide, 3) * kGravity, 1e-6);
}

// With e = 1/2 a block at rest that is hit from below by a plate at 1 m/s leaves at 1.5 m/s, in the very
// first step too.
TEST(PrescribedBody, HitsWithTheSpeedOfItsPath) {
  Scene s = block_on_plate(0, 0.5, 0, 1e-4);
  s.model.gravity = Vec3::Zero();
  s.model.bodies[s.ground].motion =
      PrescribedMotion{.path = {.t = {0, 1}, .pose = {SE3{}, translation(0, 0, 1)}}};
  const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
  ASSERT_TRUE(scheme.step(s.state).ok());
  EXPECT_NEAR(twist(s.state, s.block)[2], 1.5, 1e-6);
}

// Three blocks on each other: each contact plane carries the weight above it.
TEST(Stack, CarriesTheWeightAboveEachContact) {
  Scene s = block_on_plate(0.5, 0, 0);
  const RigidBody block = s.model.bodies[s.block];
  for (int i = 1; i < 3; ++i) {
    RigidBody next = block;
    next.name += std::to_string(i);
    add(s.model, next);
  }
  s.state = rest_state(s.model);
  for (int i = 0; i < 3; ++i)
    pose(s.state, s.block + i).p.z() = kSide / 2 + 2 * kRadius + i * (kSide + 2 * kRadius);
  const StepReport report =
      run(MoreauJean(s.model, {.h = 5e-3, .solver = {.tolerance = 1e-12}}, {.theta = 1}), s.state, 0.1);
  PerBody<double> carried(3, 0);
  for (const StepContact& c : report.contacts)
    carried[std::min(c.point.a.body, c.point.b.body)] += std::abs(c.impulse.z()) / report.h;
  const double weight = kDensity * std::pow(kSide, 3) * kGravity;
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(carried[BodyId::at(i)], (3 - i) * weight, 1e-6 * weight) << "below block " << i;
}

}  // namespace
}  // namespace aussois
