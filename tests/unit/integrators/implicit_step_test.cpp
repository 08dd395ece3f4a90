// SPDX-License-Identifier: Apache-2.0
// doc/theory/moreau_jean.md: contacts where the step leads, forces there too, and the average of the impact
// law.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// What the average gamma u+ + (1 - gamma) u- of a plastic contact means: restitution (1 - gamma) / gamma. One
// of the pair counts where it is larger; a gap over the step knows none.
TEST(VelocityAverage, BouncesLikeTheLargerRestitution) {
  using Each = std::tuple<double, NormalLaw, double>;
  for (const double gamma : {0.5, 0.8, 1.0})
    for (const auto& [restitution, law, own] :
         {Each{0, NormalLaw::moreau, 0}, Each{0, NormalLaw::gap_over_step, 0},
          Each{0.6, NormalLaw::moreau, 0.6}, Each{0.6, NormalLaw::combined, 0.6},
          Each{0.6, NormalLaw::gap_over_step, 0}}) {
      const bool refused = gamma == 1 && law == NormalLaw::gap_over_step && restitution > 0;
      if (refused) continue;
      Scene s = block_on_plate(0.3, restitution, 0);
      s.model.gravity.setZero();
      twist(s.state, s.block)[2] = -1;
      const MoreauJean scheme(s.model, {.h = 1e-4, .advancement = {.certify = false}},
                              {.theta = 0.5, .law = law, .gamma = gamma});
      const StepReport report = scheme.step(s.state);
      ASSERT_TRUE(report.ok());
      EXPECT_NEAR(twist(s.state, s.block)[2], std::max((1 - gamma) / gamma, own), 1e-7)
          << gamma << to_string(law) << restitution;
    }
}

// At theta = gamma = 1/2 impulses work on the mean velocity, where Signorini and Coulomb hold: frictionless
// contact does no work at all, and a block that bounces between its own edges keeps its energy.
TEST(VelocityAverage, AtOneHalfFrictionlessContactKeepsTheEnergy) {
  Scene s = block_on_plate(0, 0, 0, 5e-3);
  twist(s.state, s.block) << 0, 0, -1, 0.3, 1, 0;
  const MoreauJean scheme(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-13}},
                          {.theta = 0.5, .law = NormalLaw::moreau, .gamma = 0.5});
  double worked = 0, touched = 0;
  for (int k = 0; k < 400; ++k) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    worked = std::max(worked, std::abs(report.energy.contact_work));
    for (const StepContact& c : report.contacts) touched = std::max(touched, c.impulse.norm());
    EXPECT_FALSE(report.energy_rises);
  }
  EXPECT_GT(touched, 0.1);
  EXPECT_LT(worked, 1e-11);
}

// A spinning block lands: contacts that carry an impulse end closed. Linearised at the start they are off by
// the curvature of the corner's path, h^2 omega^2 / 2 of its arm: 2e-6 m here; evaluated at the end they
// hold.
TEST(ImplicitStep, HoldsTheGapAtTheEnd) {
  const auto widest = [](const auto& gap_of, const MoreauJeanOptions& own, int& most) {
    Scene s = block_on_plate(0.3, 0, 0, 0.03);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    twist(s.state, s.block) << 0.3, 0, -0.5, 6, -4, 2;
    const MoreauJean scheme(s.model, {.h = 1e-3}, own);
    double out = 0;
    for (int k = 0; k < 150; ++k) {
      const StepReport report = scheme.step(s.state);
      EXPECT_TRUE(report.ok()) << report.reason;
      if (!report.ok()) break;
      EXPECT_LT(std::abs(report.energy.residual()), 1e-13);
      most = std::max(most, report.newton_iterations);
      const ContactSet end = scheme.contacts(s.state, 1e-4);
      for (const StepContact& c : report.contacts) out = std::max(out, gap_of(c, end));
    }
    return out;
  };
  const auto gap_of = [](const StepContact& acted, const ContactSet& end) {
    for (const ContactPoint& c : end.points)
      if (key_of(c) == key_of(acted.point) && acted.impulse.norm() > 1e-4) return std::abs(c.gap);
    return 0.0;
  };
  int one = 0, several = 0, predicted = 0;
  const double plain = widest(gap_of, {.theta = 1}, one);
  const double corrected = widest(gap_of, {.theta = 1, .contacts = ContactsAt::end}, predicted);
  const double implicit = widest(
      gap_of, {.theta = 1, .contacts = ContactsAt::end, .newton = {.max_iterations = 60, .tolerance = 1e-11}},
      several);
  EXPECT_EQ(one, 1);
  EXPECT_EQ(predicted, 2);
  EXPECT_GT(several, 2);
  EXPECT_GT(plain, 1e-7);
  EXPECT_LT(corrected, 0.2 * plain);
  EXPECT_LT(implicit, 2e-11);  // the solver's and the loop's tolerance, over a step
}

// What the loop took where bodies touched, and where it ended.
struct Loop {
  int iterations = 0, most = 0, steps = 0;
  State end{};
};
Loop loop_of(const Model& model, const State& start, double h, double t_end, bool gap_hessians) {
  const MoreauJean scheme(
      model, {.h = h, .solver = {.tolerance = 1e-13}},
      {.theta = 1,
       .law = NormalLaw::gap_over_step,
       .contacts = ContactsAt::end,
       .newton = {.max_iterations = 60, .tolerance = 1e-11, .gap_hessians = gap_hessians}});
  Loop out{.end = start};
  while (out.end.t < t_end - 1e-12) {
    const StepReport report = scheme.step(out.end, t_end - out.end.t);
    EXPECT_TRUE(report.ok()) << report.reason;
    if (!report.ok()) break;
    EXPECT_LT(std::abs(report.energy.residual()), 1e-13);
    EXPECT_LT(report.momentum.residual().linear.norm(), 1e-13);
    if (report.contacts.empty()) continue;
    ++out.steps;
    out.iterations += report.newton_iterations;
    out.most = std::max(out.most, report.newton_iterations);
  }
  return out;
}

// A ball that is pressed onto a ball by thirty times its weight rolls off. Without the Hessian an iterate's
// error shrinks by h^2 F / (m d) = 0.07, to 1e-11 in eight solves; with it, it is squared.
TEST(ImplicitStep, SquaresItsErrorWithGapHessians) {
  Model model;
  model.gravity *= 30;
  model.contact_law = {.mu = 0};
  const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
  const MassProperties mass{.mass = 1, .inertia = 1e-3 * Mat3::Identity()};
  add(model, fixed_body("below", ball));
  const auto moving = add(model, solid_body("above", ball, mass));
  State state = rest_state(model);
  pose(state, moving).p.z() = 0.1;
  twist(state, moving)[0] = 0.3;
  const Loop without = loop_of(model, state, 5e-3, 0.08, false),
             with = loop_of(model, state, 5e-3, 0.08, true);
  EXPECT_GT(without.steps, 12);
  EXPECT_EQ(with.steps, without.steps);
  EXPECT_LT(with.iterations, 0.7 * without.iterations) << with.iterations << " " << without.iterations;
  EXPECT_LT(with.most, without.most);
  EXPECT_LT((pose(with.end, moving).p - pose(without.end, moving).p).norm(), 1e-10);
}

// Corners on a plate, with friction: curvature is that of their arms, small. Six landings together take fewer
// solves and none takes more in its worst step; a single one may take four of 650 more.
TEST(ImplicitStep, LosesNothingByGapHessiansWhereContactsAreFlat) {
  int with_all = 0, without_all = 0;
  for (int k = 0; k < 6; ++k) {
    Scene s = block_on_plate(0.3, 0, 0, 0.03);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1 + 0.01 * k));
    twist(s.state, s.block) << 0.3, 0, -0.5, 6, -4, 2 + 0.05 * k;
    const Loop without = loop_of(s.model, s.state, 1e-3, 0.15, false),
               with = loop_of(s.model, s.state, 1e-3, 0.15, true);
    EXPECT_GT(without.steps, 100);
    EXPECT_LE(with.most, without.most) << k;
    EXPECT_LT((pose(with.end, s.block).p - pose(without.end, s.block).p).norm(), 1e-8) << k;
    with_all += with.iterations;
    without_all += without.iterations;
  }
  EXPECT_LE(with_all, without_all);
}

// A pendulum in its angle: v+ - v = -h (g / l) sin q_theta holds as it stands, not only linearised.
TEST(ImplicitStep, HoldsTheMomentumBalance) {
  Model model;
  const double k = 9.81;
  add(model, Coordinates{.name = "angle",
                         .size = 1,
                         .mass = [](const VecX&) -> MatX { return MatX::Identity(1, 1); },
                         .force =
                             [k](double, const VecX& q, const VecX&) {
                               return CoordinateForce{.f = VecX::Constant(1, -k * std::sin(q[0])),
                                                      .K = MatX::Constant(1, 1, k * std::cos(q[0])),
                                                      .C = {}};
                             },
                         .potential = {}});
  const double h = 0.05;
  for (const double theta : {0.5, 1.0})
    for (const int iterations : {1, 30}) {
      State state = rest_state(model);
      state.q[0] = 2;
      state.v[0] = 3;
      const MoreauJean scheme(model, {.h = h}, {.theta = theta, .newton = {.max_iterations = iterations}});
      double off = 0;
      for (int i = 0; i < 20; ++i) {
        const double q = state.q[0], v = state.v[0];
        const StepReport report = scheme.step(state);
        ASSERT_TRUE(report.ok());
        const double v_theta = theta * state.v[0] + (1 - theta) * v;
        off = std::max(off, std::abs(state.v[0] - v + h * k * std::sin(q + theta * h * v_theta)));
        EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
      }
      if (iterations > 1)
        EXPECT_LT(off, 1e-9) << theta;
      else
        EXPECT_GT(off, 1e-6) << theta;
    }
}

// Euler's equations at the implicit midpoint keep energy and the momentum's norm; turned by Cayley's map the
// momentum keeps its direction too.
TEST(ImplicitStep, KeepsTheMomentumOfATopInSpaceWithCayleysMap) {
  const auto drift = [](GroupUpdate update) {
    Model model;
    model.gravity.setZero();
    add(model, RigidBody{.name = "top", .mass = 1, .inertia = Vec3(1, 2, 3).asDiagonal()});
    State state = rest_state(model);
    twist(state, 0).tail<3>() = Vec3(0.6, 1, 1.3);
    const Vec3 L = momentum(model, state).angular;
    const MoreauJean scheme(model, {.h = 0.05, .update = update},
                            {.theta = 0.5, .newton = {.max_iterations = 60, .tolerance = 1e-14}});
    for (int k = 0; k < 500; ++k) EXPECT_TRUE(scheme.step(state).ok());
    return (momentum(model, state).angular - L).norm() / L.norm();
  };
  EXPECT_LT(drift(GroupUpdate::cayley), 1e-12);
  EXPECT_GT(drift(GroupUpdate::exponential), 1e-6);
}

// A free top: the implicit midpoint of Euler's equations in the body keeps energy and momentum norm.
TEST(ImplicitStep, KeepsTheEnergyOfATop) {
  Model model;
  model.gravity.setZero();
  add(model, RigidBody{.name = "top", .mass = 1, .inertia = Vec3(1, 2, 3).asDiagonal()});
  State state = rest_state(model);
  twist(state, 0).tail<3>() = Vec3(0.6, 1, 1.3);
  const double E = energy(model, state).kinetic, L = momentum(model, state).angular.norm();
  const MoreauJean scheme(model, {.h = 0.05},
                          {.theta = 0.5, .newton = {.max_iterations = 60, .tolerance = 1e-14}});
  for (int k = 0; k < 2000; ++k) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.newton_change;
  }
  EXPECT_NEAR(energy(model, state).kinetic / E, 1, 1e-12);
  EXPECT_NEAR(momentum(model, state).angular.norm() / L, 1, 1e-12);
}

TEST(ImplicitStep, HalvesAStepWhoseLoopDoesNotConvergeAndSaysSo) {
  Scene s = block_on_plate(0.3, 0, 0, 1e-4);
  twist(s.state, s.block) << 0, 0, -0.5, 6, -4, 2;
  const MoreauJean scheme(
      s.model, {.h = 1e-3},
      {.theta = 1, .contacts = ContactsAt::end, .newton = {.max_iterations = 2, .tolerance = 1e-300}});
  const StepReport report = scheme.step(s.state);
  EXPECT_EQ(report.status, StepStatus::not_solved);
  EXPECT_TRUE(report.moved());
  EXPECT_LT(report.h, 1e-3);
  EXPECT_GT(report.newton_change, 0);
}

TEST(ImplicitStep, NamesBadOptions) {
  const Scene s = block_on_plate(0, 0, 0);
  const auto refusal = [&](const NewtonOptions& newton) {
    return message_of([&] { MoreauJean(s.model, {}, {.newton = newton}); });
  };
  EXPECT_NE(refusal({.max_iterations = 0}).find("max_iterations"), std::string::npos);
  EXPECT_NE(refusal({.tolerance = 0}).find("tolerance"), std::string::npos);
}

}  // namespace
}  // namespace aussois
