// SPDX-License-Identifier: Apache-2.0
// A4, balls in a row that touch (doc/theory/mechanism_benchmarks.md): a column at rest, and cradles.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81, kStep = 1e-3;

/// One step from a cold start: how far the contact below sphere k is from the weight above it, relative.
struct Weighed {
  double error = 0;
  StepReport report{};
};
Weighed weigh(int beads, const SolverOptions& solver) {
  const CaseScene s = bead_column(beads);
  SchemeOptions options{.h = kStep, .theta = 0.5, .advancement = {.certify = false}};
  options.solver = solver;
  const Scheme scheme = make_scheme("moreau_jean", s.model, options);
  State state = s.state;
  Weighed out;
  out.report = scheme.step(state, kInf);
  std::vector<double> push(std::size_t(beads) + 1);
  for (const StepContact& c : out.report.contacts)
    push[std::size_t(std::max(c.point.a.body, c.point.b.body))] += std::abs(c.impulse.z()) / kStep;
  for (int k = 1; k <= beads; ++k)
    out.error = std::max(out.error, std::abs(push[std::size_t(k)] / ((beads - k + 1) * kGravity) - 1));
  return out;
}

// The hard case of sweeps: each carries a weight one sphere further. The default gives it to Newton.
TEST(Column, OfAThousandBeadsCarriesTheWeightAboveEachInOneStep) {
  const Weighed all = weigh(1000, {.tolerance = 1e-12});
  EXPECT_TRUE(all.report.ok());
  EXPECT_EQ(all.report.contacts.size(), 1000u);
  EXPECT_LT(all.error, 1e-6);
  EXPECT_NE(all.report.solve.found_by, Method::nsgs);
  EXPECT_LT(all.report.solve.newton_iterations, 100);
}

// What sweeps alone would need: about n^2 of them.
TEST(Column, NeedsSweepsThatGrowWithTheSquareOfItsBeads) {
  const auto sweeps = [](int beads) {
    const Weighed one = weigh(beads, {.method = Method::nsgs, .tolerance = 1e-10, .max_iterations = 200000});
    EXPECT_TRUE(one.report.ok());
    EXPECT_LT(one.error, 1e-4);
    return double(one.report.solve.iterations);
  };
  const double ten = sweeps(10), forty = sweeps(40);
  EXPECT_NEAR(std::log(forty / ten) / std::log(4), 2, 0.3);
}

CaseScene cradle(const std::vector<double>& masses) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0, .restitution = 1};
  const int ball = add(s.model, prepare(dilate(make_point(), 0.05)));
  for (const double m : masses)
    add(s.model, RigidBody{.name = "ball", .shape = ball, .mass = m, .inertia = 1e-3 * m * Mat3::Identity()});
  s.state = rest_state(s.model);
  for (int i = 0; i < int(masses.size()); ++i) pose(s.state, i).p.x() = i * (0.1 - 1e-15);
  twist(s.state, 0)[0] = 1;
  return s;
}

std::vector<double> speeds_after(const std::vector<double>& masses, ImpactOrder order) {
  SchemeOptions options = mechanism_options(kStep);
  options.impact.order = order;
  const State end = run_scene(cradle(masses), "moreau_jean", options, kStep);
  std::vector<double> out;
  for (int i = 0; i < int(masses.size()); ++i) out.push_back(twist(end, i)[0]);
  return out;
}

// All contacts at once: W r = 2 u of the first contact, solved by hand for n equal balls (MCH-9): the last
// of r = 2 (n - k) / n is what all others leave with.
TEST(Cradle, OfEqualBallsSharesTheBlowOrPassesItOn) {
  for (const int n : {2, 3, 5, 10}) {
    const std::vector<double> masses(std::size_t(n), 1),
        once = speeds_after(masses, ImpactOrder::simultaneous),
        turn = speeds_after(masses, ImpactOrder::sequential);
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(once[std::size_t(i)], i == 0 ? 2.0 / n - 1 : 2.0 / n, 1e-12) << n << " balls, ball " << i;
      EXPECT_NEAR(turn[std::size_t(i)], i == n - 1 ? 1 : 0, 1e-12) << n << " balls, ball " << i;
    }
  }
}

// A micrometre apart, in steps a thousand times longer than it takes to close. Moreau's law asks what closes
// by itself, so the blow is passed on; the combined law asks all that come within the step, so it is shared,
// up to the speed that closes the gap in a step.
TEST(Cradle, OfBallsThatNearlyTouchFollowsItsNormalLaw) {
  constexpr double kGap = 1e-6;
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined}) {
    CaseScene s = cradle({1, 1, 1});
    for (int i = 0; i < 3; ++i) pose(s.state, i).p.x() += kGap * i;
    SchemeOptions options = mechanism_options(kStep);
    options.normal.law = law;
    const State end = run_scene(s, "moreau_jean", options, 10 * kStep);
    const Vec3 v(twist(end, 0)[0], twist(end, 1)[0], twist(end, 2)[0]);
    const bool shares = law == NormalLaw::combined;
    const Vec3 right = shares ? Vec3(-1, 2, 2) / 3 : Vec3(0, 0, 1);
    EXPECT_LT((v - right).norm(), shares ? kGap / kStep : 1e-12) << to_string(law) << ": " << v.transpose();
  }
}

// Unequal ones, e = 1: at once all but the first leave as one body of their common mass; pair by pair each
// hands over 2 m / (m + m').
TEST(Cradle, OfUnequalBallsDoesTheSameWithTheirMasses) {
  const std::vector<double> masses{3, 2, 1};
  const std::vector<double> once = speeds_after(masses, ImpactOrder::simultaneous);
  EXPECT_NEAR(once[0], 0, 1e-12);  // 3 kg on 2 + 1 kg
  EXPECT_NEAR(once[1], 1, 1e-12);
  EXPECT_NEAR(once[2], 1, 1e-12);
  const std::vector<double> turn = speeds_after(masses, ImpactOrder::sequential);
  const double first = 2.0 * 3 / 5, second = 2.0 * 2 / 3 * first;
  EXPECT_NEAR(turn[0], 1.0 / 5, 1e-12);
  EXPECT_NEAR(turn[1], first / 3, 1e-12);
  EXPECT_NEAR(turn[2], second, 1e-12);
}

}  // namespace
}  // namespace aussois
