// SPDX-License-Identifier: Apache-2.0
// The exact motions of the scenes: events known in closed form, balances, and the shared reference series.
#include "examples/scenes/cases.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "integrators/scheme.hpp"
#include "tests/support/reference.hpp"

namespace aussois {
namespace {

ExactMotion motion_of(const char* name) {
  return case_named(name).exact(case_named(name).t_end);
}

class EachCase : public ::testing::TestWithParam<std::string> {};

// The exact motion begins where the scene begins, and its position is the integral of its velocity: the
// pieces join, and q is continuous over them.
TEST_P(EachCase, BeginsAtItsSceneAndIsContinuous) {
  const Case& c = case_named(GetParam());
  const CaseScene scene = c.scene();
  ASSERT_NO_THROW(validate(scene.model));
  const ExactMotion exact = c.exact(c.t_end);
  const MotionSample start = c.observe(scene, scene.state), begin = evaluate(exact, 0);
  EXPECT_LT((start.q - begin.q).norm(), 1e-13);
  EXPECT_LT((start.v - begin.v).norm(), 1e-13);
  ASSERT_EQ(exact.pieces.front().begin, 0);
  for (std::size_t k = 1; k < exact.pieces.size(); ++k) {
    const double t = exact.pieces[k].begin;
    ASSERT_GE(t, exact.pieces[k - 1].begin);
    EXPECT_LT((exact.pieces[k].at(t).q - exact.pieces[k - 1].at(t).q).norm(), 1e-12) << "at t = " << t;
  }
}

// Central differences of q are v (or, for tops and the rolling sphere, contain it).
TEST_P(EachCase, MovesWithItsVelocity) {
  const ExactMotion exact = motion_of(GetParam().c_str());
  const double t_end = case_named(GetParam()).t_end, d = 1e-5 * std::min(1.0, t_end);
  int compared = 0;
  for (double t = t_end / 97; t < t_end - d; t += t_end / 37) {
    if (piece_at(exact, t - d) != piece_at(exact, t + d)) continue;
    const MotionSample before = evaluate(exact, t - d), now = evaluate(exact, t),
                       after = evaluate(exact, t + d);
    const VecX rate = (after.q - before.q) / (2 * d);
    if (now.q.size() == 6) {  // axes x and z of a body that turns at omega
      Mat3 R;
      R.col(0) = now.q.head<3>(), R.col(2) = now.q.tail<3>(), R.col(1) = R.col(2).cross(R.col(0));
      const Vec3 omega = R * Vec3(now.v);
      EXPECT_LT((rate.head<3>() - omega.cross(R.col(0))).norm(), 1e-6);
      EXPECT_LT((rate.tail<3>() - omega.cross(R.col(2))).norm(), 1e-6);
    } else {
      EXPECT_LT((rate - now.v.head(now.q.size())).norm(), 1e-6 * (1 + now.v.norm())) << "t = " << t;
    }
    ++compared;
  }
  EXPECT_GT(compared, 25);
}
std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const Case& c : cases()) names.push_back(c.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Cases, EachCase, ::testing::ValuesIn(case_names()),
                         [](const auto& name) { return name.param; });

TEST(Cases, AreRefusedByAnUnknownName) {
  EXPECT_THROW(case_named("perpetuum_mobile"), std::invalid_argument);
}

TEST(BouncingBall, RestsAtItsAccumulationPoint) {
  const double t1 = std::sqrt(2 / kGravity), e = 0.5;
  const ExactMotion ball = motion_of("ball_e05");
  EXPECT_NEAR(ball.pieces.back().begin, t1 * (1 + e) / (1 - e), 1e-12);
  EXPECT_EQ(evaluate(ball, 1.45).v[0], 0);
  REFERENCE(events, "bouncing_ball_events.csv");
  for (std::size_t k = 0; k < 30; ++k) {
    EXPECT_NEAR(ball.pieces[k + 1].begin, events[k].at("t_s"), 1e-13);
    EXPECT_NEAR(ball.pieces[k + 1].at(ball.pieces[k + 1].begin).v[0], events[k].at("v_plus_m_s"), 1e-12);
  }
}

// The orbit obeys the impact law, closes, and never goes through the stop.
TEST(ForcedOscillator, RepeatsItselfWithOneImpactInEachPeriod) {
  const std::tuple<const char*, double, double> setups[] = {
      {"forced_28", 2.8, 0.8}, {"forced_26", 2.6, 0.8}, {"forced_46", 4.6, 0.7}};
  for (const auto& [name, W, e] : setups) {
    const ExactMotion orbit = motion_of(name);
    ASSERT_GE(orbit.pieces.size(), 2u);
    for (std::size_t k = 1; k < orbit.pieces.size(); ++k) {
      const double t = orbit.pieces[k].begin;
      EXPECT_NEAR(orbit.pieces[k].at(t).q[0], 0, 1e-13);
      EXPECT_LT(orbit.pieces[k - 1].at(t).v[0], -0.01);
      EXPECT_NEAR(orbit.pieces[k].at(t).v[0], -e * orbit.pieces[k - 1].at(t).v[0], 1e-13);
    }
    for (double t = 0; t + 2 * kPi / W < case_named(name).t_end; t += 0.01) {
      EXPECT_GT(evaluate(orbit, t).q[0], -1e-12) << name << " at " << t;
      EXPECT_NEAR(evaluate(orbit, t).q[0], evaluate(orbit, t + 2 * kPi / W).q[0], 1e-12);
    }
  }
}

// From the work of gravity and friction on the way up, and the mean speed of a uniform motion.
TEST(Incline, StopsWhereGravityAndFrictionStopIt) {
  const double slope = kPi / 6, way = 2.0 * 2.0 / 2 / (kGravity * (std::sin(slope) + 0.5 * std::cos(slope)));
  const ExactMotion up = motion_of("incline_30_up");
  const double stop = up.pieces[1].begin;
  EXPECT_NEAR(stop, way / (2.0 / 2), 1e-14);
  EXPECT_NEAR(evaluate(up, stop).q[0], -way, 1e-14);
  const double down = kGravity * (std::sin(slope) - 0.5 * std::cos(slope));
  EXPECT_NEAR(evaluate(up, 0.3).v[0], down * (0.3 - stop), 1e-14);
  EXPECT_EQ(evaluate(motion_of("incline_20_up"), 0.45).v[0], 0);
  EXPECT_NEAR(evaluate(motion_of("incline_30"), 0.5).v[0], down * 0.5, 1e-14);
}

TEST(StickSlip, HasThePhasesOfTheReference) {
  const ExactMotion block = motion_of("stick_slip");
  EXPECT_NEAR(block.pieces[1].begin, std::asin(0.3 * kGravity / 6) / 2, 1e-14);
  REFERENCE(phases, "block_stick_slip.csv");
  std::size_t k = 1;
  for (const SeriesRow& phase : phases) {  // under 6 N each slip follows the one before at once
    if (phase.at("slip_start_s") > 4.9) break;
    ASSERT_LT(k, block.pieces.size());
    EXPECT_NEAR(block.pieces[k].begin, phase.at("slip_start_s"), 1e-12);
    EXPECT_NEAR(block.pieces[k].at(phase.at("slip_end_s")).q[0], phase.at("position_after_m"), 1e-12);
    EXPECT_NEAR(block.pieces[k].at(phase.at("slip_end_s")).v[0], 0, 1e-12);
    ++k;
  }
  EXPECT_EQ(k, 4u);
}

TEST(SlipToRoll, AgreesWithTheReferenceFromThreeStarts) {
  const ExactMotion bowling = motion_of("bowling");
  EXPECT_NEAR(bowling.pieces[1].begin, 2 * 5 / (7 * 0.2 * kGravity), 1e-14);
  EXPECT_NEAR(evaluate(bowling, 1).v[0], 25.0 / 7, 1e-14);
  REFERENCE(rows, "sphere_slip_roll.csv");
  for (const SeriesRow& row : rows) {
    const char* name = row.at("w0x") == 40 ? "side_spin" : row.at("w0y") == -80 ? "back_spin" : "bowling";
    const MotionSample sample = evaluate(motion_of(name), row.at("t_s"));
    EXPECT_NEAR(sample.q[0], row.at("x"), 1e-12);
    EXPECT_NEAR(sample.q[1], row.at("y"), 1e-12);
    EXPECT_NEAR(sample.v[0], row.at("vx"), 1e-12);
    EXPECT_NEAR(sample.v[1], row.at("vy"), 1e-12);
    EXPECT_NEAR(sample.v[3], 0.1 * row.at("wx"), 1e-11);
    EXPECT_NEAR(sample.v[4], 0.1 * row.at("wy"), 1e-11);
    EXPECT_NEAR(sample.v[5], 0.1 * row.at("wz"), 1e-11);
  }
}

TEST(RockingBlock, HasHousnersImpacts) {
  const ExactMotion block = motion_of("rocking_block");
  REFERENCE(events, "rocking_block_events.csv");
  ASSERT_GE(block.pieces.size(), 4u);
  for (std::size_t k = 1; k < block.pieces.size(); ++k) {
    const double t = block.pieces[k].begin;
    EXPECT_NEAR(t, events[k - 1].at("t_s"), 1e-10);
    EXPECT_NEAR(std::abs(block.pieces[k - 1].at(t).v[0]), events[k - 1].at("omega_minus"), 1e-10);
    EXPECT_NEAR(std::abs(block.pieces[k].at(t).v[0]), events[k - 1].at("omega_plus"), 1e-10);
  }
}

// Momentum in the world and energy of a free top do not change, and say nothing about how it was integrated.
// The two corners on one side are one contact, but for 4e-12 of the velocity: which of them ends closed is no
// matter of a displacement of nanometres, and the step is solved.
TEST(SliderCrank, LandsOnCornersThatAreOneContact) {
  CaseScene s = case_named("slider_crank").scene();
  SchemeOptions o{.step = {.h = 3.648050649609605e-07, .solver = {.tolerance = 1e-12}},
                  .moreau_jean = {.theta = 0.5}};
  o.moreau_jean.law = NormalLaw::combined;
  const Scheme scheme = make_scheme("moreau_jean", s.model, o);
  ASSERT_TRUE(scheme.step(s.state, 0.625 * o.step.h).ok());
  while (s.state.t < 0.0027) {  // the first impact is at 0.0026925 s
    const StepReport report = scheme.step(s.state, 1);
    ASSERT_TRUE(report.ok()) << s.state.t << " s: " << report.reason;
  }
}

TEST(FreeTop, KeepsItsMomentumAndEnergy) {
  const std::pair<const char*, Vec3> tops[] = {{"free_top", {3, 2, 1}}, {"dzhanibekov", {1, 10, 11}}};
  for (const auto& [name, J] : tops) {
    const ExactMotion top = motion_of(name);
    const auto momentum = [&, J = J](double t) -> Vec3 {
      const MotionSample s = evaluate(top, t);
      Mat3 R;
      R.col(0) = s.q.head<3>(), R.col(2) = s.q.tail<3>(), R.col(1) = R.col(2).cross(R.col(0));
      return R * J.cwiseProduct(Vec3(s.v));
    };
    const auto energy = [&, J = J](double t) { return Vec3(evaluate(top, t).v).cwiseAbs2().dot(J) / 2; };
    for (const double t : {0.3, 4.0, 9.9}) {
      EXPECT_LT((momentum(t) - momentum(0)).norm(), 1e-11 * momentum(0).norm()) << name;
      EXPECT_NEAR(energy(t), energy(0), 1e-11 * energy(0)) << name;
    }
  }
}

TEST(HeavyTop, AgreesWithTheReference) {
  REFERENCE(rows, "heavy_top.csv");
  const ExactMotion top = case_named("heavy_top").exact(2);
  for (const SeriesRow& row : rows) {
    const MotionSample sample = evaluate(top, row.at("t_s"));
    EXPECT_LT((Vec3(sample.q) - Vec3(row.at("x"), row.at("y"), row.at("z"))).norm(), 1e-9)
        << "t = " << row.at("t_s");
  }
}

}  // namespace
}  // namespace aussois
