// SPDX-License-Identifier: Apache-2.0
// doc/theory/impacts.md: what balls, a rod and a pendulum do, worked out by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr ImpactOptions kNewton{}, kPoisson{.law = ImpactLaw::poisson},
    kPairs{.order = ImpactOrder::sequential},
    kPoissonPairs{.law = ImpactLaw::poisson, .order = ImpactOrder::sequential};

struct Balls {
  Model model{};
  State state{};
  explicit Balls(double restitution, const std::vector<double>& masses) {
    model.gravity = Vec3::Zero();
    model.contact_law = {.mu = 0, .restitution = restitution};
    const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
    for (const double m : masses)
      add(model, RigidBody{.name = "ball", .shape = ball, .mass = m, .inertia = 1e-3 * m * Mat3::Identity()});
    state = rest_state(model);
    for (int i = 0; i < int(masses.size()); ++i) pose(state, BodyId::at(i)).p.x() = i * (0.1 - 1e-15);
    twist(state, 0)[0] = 1;
  }
};

// One step; speeds of the balls after it.
std::vector<double> speeds_after(Balls balls, const ImpactOptions& impact,
                                 NormalLaw law = NormalLaw::moreau) {
  const StepReport report =
      MoreauJean(balls.model, {}, {.theta = 0.5, .law = law, .impact = impact}).step(balls.state);
  EXPECT_TRUE(report.ok()) << report.reason;
  EXPECT_FALSE(report.energy_rises);
  EXPECT_LT(std::abs(report.energy.residual()), 1e-14);
  std::vector<double> out;
  for (const BodyId b : balls.model.bodies.ids()) out.push_back(twist(balls.state, b)[0]);
  return out;
}

void expect_speeds(const std::vector<double>& speeds, const std::vector<double>& wanted) {
  ASSERT_EQ(speeds.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(speeds[i], wanted[i], 1e-12) << "ball " << i;
}

TEST(ThreeBalls, ShareTheBlowAtOnceAndPassItOnPairByPair) {
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined}) {
    const Balls balls(1, {1, 1, 1});
    expect_speeds(speeds_after(balls, kNewton, law), {-1.0 / 3, 2.0 / 3, 2.0 / 3});
    expect_speeds(speeds_after(balls, kPoisson, law), {-1.0 / 3, 2.0 / 3, 2.0 / 3});
    expect_speeds(speeds_after(balls, kPairs, law), {0, 0, 1});
    expect_speeds(speeds_after(balls, kPoissonPairs, law), {0, 0, 1});
  }
}

// e = 1/2, pair by pair: 1 -> (1/4, 3/4); 3/4 -> (3/16, 9/16); then the first catches up by 1/16.
TEST(ThreeBalls, MeetAsOftenAsItTakes) {
  expect_speeds(speeds_after(Balls(0.5, {1, 1, 1}), kPairs), {13.0 / 64, 15.0 / 64, 36.0 / 64});
}

// Plastic pairs go on for ever, each time by a part of what is left: the limit is the common speed.
TEST(ThreeBalls, EndTogetherWhenPlastic) {
  expect_speeds(speeds_after(Balls(0, {1, 1, 1}), kPairs), {1.0 / 3, 1.0 / 3, 1.0 / 3});
}

// Masses 2, 1, 2: compression ends at the common speed 2/5, by impulses 2 - 4/5 = 6/5 and 2 * 2/5 = 4/5; with
// half of that again they are 9/5 and 6/5.
TEST(ThreeBalls, ExpandByPoissonAsTheyWereCompressed) {
  expect_speeds(speeds_after(Balls(0.5, {2, 1, 2}), kPoisson), {1 - 0.9, 1.8 - 1.2, 0.6});
}

TEST(SequentialImpacts, KeepMomentumAndNeverGainEnergyInRandomPiles) {
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  Random random(seed);
  int impacts = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Balls balls(0.8, {1, 2, 0.5, 1, 3});
    balls.model.contact_law.mu = 0.3;
    for (int b = 0; b < 5; ++b) {
      const double angle = 2 * kPi * b / 4;  // four around the first
      pose(balls.state, BodyId::at(b)).p =
          b == 4 ? Vec3(0, 0, 0) : Vec3(0.1 * Vec3(std::cos(angle), std::sin(angle), 0));
      for (int i = 0; i < 6; ++i) twist(balls.state, BodyId::at(b))[i] = random.uniform(-1, 1);
    }
    const Momentum before = momentum(balls.model, balls.state);
    const ImpactOptions o = trial % 2 == 0 ? kPairs : kPoissonPairs;
    const Vec3 middle_before = twist(balls.state, 4).head<3>();
    const double E = energy(balls.model, balls.state).kinetic;
    const StepReport report =
        MoreauJean(balls.model, {.h = 1e-4}, {.theta = 1, .law = NormalLaw::moreau, .impact = o})
            .step(balls.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    impacts += report.impact_solves;
    EXPECT_GE(report.solve.iterations, report.impact_solves) << "what impacts take is told";
    EXPECT_LT((momentum(balls.model, balls.state).linear - before.linear).norm(), 1e-12);
    EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
    EXPECT_LE(energy(balls.model, balls.state).kinetic, E * (1 + 1e-6));
    Vec3 on_middle = Vec3::Zero();  // what the report says of it is what moved it
    for (const StepContact& c : report.contacts)
      if (c.point.a.body == 4 || c.point.b.body == 4) on_middle += (c.point.a.body == 4 ? 1 : -1) * c.impulse;
    EXPECT_LT((3 * (twist(balls.state, 4).head<3>() - middle_before) - on_middle).norm(), 1e-11);
  }
  EXPECT_GT(impacts, 40);
}

// A sphere that strikes the floor at a slant and slides throughout: the friction of compression and of
// expansion is mu (1 + e) m V together.
TEST(PoissonImpact, SlidesByTheFrictionOfBothPhases) {
  const double mu = 0.1, e = 0.6, V = 2, R = 0.05;
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law = {.mu = mu, .restitution = e};
  const auto floor = add(model, prepare(dilate(make_plate(4, 4), 1e-3)));
  const auto ball = add(model, prepare(dilate(make_point(), R)));
  add(model, fixed_body("floor", floor));
  add(model, RigidBody{.name = "ball", .shape = ball, .mass = 2, .inertia = 2e-3 * Mat3::Identity()});
  for (const ImpactOrder order : {ImpactOrder::simultaneous, ImpactOrder::sequential}) {
    State state = rest_state(model);
    pose(state, 1).p.z() = R + 1e-3;
    twist(state, 1) << 5, 0, -V, 0, 0, 0;
    const StepReport report =
        MoreauJean(
            model, {.h = 1e-4},
            {.theta = 1, .law = NormalLaw::moreau, .impact = {.law = ImpactLaw::poisson, .order = order}})
            .step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_NEAR(twist(state, 1)[2], e * V, 1e-12);
    EXPECT_NEAR(twist(state, 1)[0], 5 - mu * (1 + e) * V, 1e-12);
    EXPECT_NEAR(twist(state, 1)[4], mu * (1 + e) * V * 2 * R / 2e-3, 1e-9);
    ASSERT_EQ(report.contacts.size(), 1U);
    EXPECT_NEAR(std::abs(report.contacts[0].impulse.z()), 2 * (1 + e) * V, 1e-11);
  }
}

// A hinged ball that strikes a wall: the hinge takes part, the spin turns round by e.
TEST(ImpactOfAMechanism, TurnsAPendulumRound) {
  for (const ImpactOptions& o : {kNewton, kPoisson, kPairs, kPoissonPairs}) {
    Model model;
    model.gravity = Vec3::Zero();
    model.contact_law = {.mu = 0, .restitution = 0.5};
    const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
    const auto plate = add(model, prepare(dilate(make_plate(2, 2), 1e-3)));
    add(model, RigidBody{.name = "ball", .shape = ball, .mass = 1, .inertia = 1e-3 * Mat3::Identity()});
    add(model, fixed_body("wall", plate));
    State state = rest_state(model);
    pose(state, 0).p = Vec3(1, 0, 0.051);
    add(model, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g,
                        translation(0, 0, 0.051) * rotation(Vec3::UnitX(), -kPi / 2)));
    twist(state, 0) << 0, 0, -1, 0, 1, 0;  // about y through the hinge
    const StepReport report =
        MoreauJean(model, {.h = 1e-4}, {.theta = 0.5, .law = NormalLaw::moreau, .impact = o}).step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_NEAR(twist(state, 0)[4], -0.5, 1e-7)
        << name_of(o.law, kImpactLaws) << name_of(o.order, kImpactOrders);
    EXPECT_NEAR(twist(state, 0)[2], 0.5, 1e-7);
    EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
  }
}

TEST(ImpactOptions, AreRefusedAtTheDoor) {
  const Balls balls(1, {1, 1});
  const auto refusal = [&](const MoreauJeanOptions& own) {
    return message_of([&] { MoreauJean(balls.model, {}, own); });
  };
  EXPECT_NE(
      refusal({.law = NormalLaw::gap_over_step, .impact = kPoisson}).find("needs MoreauJeanOptions::law"),
      std::string::npos);
  EXPECT_NE(refusal({.impact = {.max_pairs = 0}}).find("max_pairs"), std::string::npos);
  EXPECT_NE(refusal({.contacts = ContactsAt::end, .impact = kPairs}).find("contacts"), std::string::npos);
  EXPECT_NE(refusal({.gamma = 0.5, .impact = kPairs}).find("gamma"), std::string::npos);
  EXPECT_NE(refusal({.gamma = 0.4}).find("gamma"), std::string::npos);
}

}  // namespace
}  // namespace aussois
