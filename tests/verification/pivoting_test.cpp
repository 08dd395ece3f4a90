// SPDX-License-Identifier: Apache-2.0
// B4, B5: Contensou's friction in every scheme, against the closed motion of its ellipsoid law; on plates
// that move by themselves too.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/study.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81;

SchemeOptions options(double h) {
  return {.h = h, .theta = 0.5, .solver = {.tolerance = 1e-12}, .advancement = {.certify = false}};
}

State run(const CaseScene& s, const std::string& name, double h, double t_end) {
  const Scheme scheme = make_scheme(name, s.model, options(h));
  State state = s.state;
  while (state.t < t_end * (1 - 1e-12)) {
    const StepReport report = scheme.step(state, t_end - state.t);
    EXPECT_TRUE(report.ok()) << name << ": " << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
  }
  return state;
}

/// The plate follows its own velocity and spin about z.
void move_plate(CaseScene& s, const Vec3& v, double spin, double t_end) {
  constexpr double kRow = 0.05;
  Trajectory path;
  for (int k = 0; (k - 1) * kRow < t_end; ++k) {
    const double t = k * kRow;
    path.t.push_back(t);
    path.pose.push_back({rotation(Vec3::UnitZ(), spin * t).R, t * v});
  }
  s.model.bodies[0].motion = Prescribed{path};
}

class EverySchemeAndSpin : public ::testing::TestWithParam<std::string> {};

TEST_P(EverySchemeAndSpin, FollowsTheEllipsoidLaw) {
  for (const char* name : {"spinning_disc", "sliding_disc", "pivoting_sphere"}) {
    const Case& c = case_named(name);
    const CaseScene s = c.scene();
    const ExactMotion exact = c.exact(c.t_end);
    for (const double part : {0.3, 0.7, 1.0}) {
      const double h = 1e-3, t = part * c.t_end;
      const MotionSample computed = c.observe(s, run(s, GetParam(), h, t)), right = evaluate(exact, t);
      EXPECT_LT((computed.q - right.q).norm(), 2 * h) << name << " at " << t;
      EXPECT_LT((computed.v - right.v).norm(), 5 * h) << name << " at " << t;
    }
  }
}

// Galilei: on a plate that moves straight on, the same motion beside it.
TEST_P(EverySchemeAndSpin, IsTheSameOnAPlateThatMovesStraightOn) {
  const double t = 0.3;
  const Vec3 v(0.4, -0.3, 0);
  const CaseScene still = case_named("spinning_disc").scene();
  CaseScene moving = case_named("spinning_disc").scene();
  move_plate(moving, v, 0, 1);
  twist(moving.state, moving.body).head<3>() += v;
  twist(moving.state, 0).head<3>() = v;
  const State a = run(still, GetParam(), 2e-3, t), b = run(moving, GetParam(), 2e-3, t);
  EXPECT_LT((pose(b, moving.body).p - t * v - pose(a, still.body).p).norm(), 1e-8);
  EXPECT_LT((twist(b, moving.body).head<3>() - v - twist(a, still.body).head<3>()).norm(), 1e-8);
  EXPECT_NEAR(twist(b, moving.body)[5], twist(a, still.body)[5], 1e-7);
}

// On a turntable of 8 rad/s a disc of 30 rad/s loses 2 mu g R_e / R^2 per second until it goes along.
TEST_P(EverySchemeAndSpin, IsCaughtByATurntable) {
  const double table = 8, begin = 30, R = 0.1, rate = 2 * 0.3 * kGravity * (2 * R / 3) / (R * R);
  const double caught = (begin - table) / rate, h = GetParam() == std::string("event_driven") ? 2e-2 : 2e-3;
  CaseScene s = case_named("spinning_disc").scene();
  move_plate(s, Vec3::Zero(), table, 2);
  twist(s.state, 0)[5] = table;
  twist(s.state, s.body) << 0, 0, 0, 0, 0, begin;
  const double t = 0.5 * caught;
  EXPECT_NEAR(twist(run(s, GetParam(), h, t), s.body)[5], begin - rate * t, rate * h);
  EXPECT_NEAR(twist(run(s, GetParam(), h, caught + 2 * h), s.body)[5], table, 1e-6);
  EXPECT_NEAR(twist(run(s, GetParam(), h, 1.5 * caught), s.body)[5], table, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Schemes, EverySchemeAndSpin, ::testing::ValuesIn(scheme_names()),
                         [](const auto& name) { return name.param; });

// B5. Three seconds: rolling since 0.1 s, then the pivot spin falls by 5/2 mu g R_e / R^2 per second.
TEST(PivotingSphere, RollsOnWhileItsPivotSpinDecays) {
  const Case& c = case_named("pivoting_sphere");
  const CaseScene s = c.scene();
  const double R = 0.05, R_e = 3 * kPi / 16 * 2e-3, rate = 2.5 * 0.3 * kGravity * R_e / (R * R), t = 3;
  const MotionSample right = evaluate(c.exact(t), t);
  EXPECT_NEAR((evaluate(c.exact(t), 1).v[1] - right.v[1]) / R, 2 * rate, 1e-9);
  EXPECT_NEAR(right.v[0], 5.0 / 7, 1e-12);  // no slip is left
  const MotionSample computed = c.observe(s, run(s, "moreau_jean", 1e-3, t));
  EXPECT_NEAR(computed.v[0], right.v[0], 3e-4);
  EXPECT_NEAR(computed.v[1] / R, right.v[1] / R, 3e-3);
  EXPECT_NEAR(computed.q[0], right.q[0], 1e-3);
}

// The closed motion of the disc stops both at once; slip over drilling speed falls as exp(-(1 - b) tau), b =
// 8/9.
TEST(SpinningDisc, StopsSlidingAndSpinningAtOnce) {
  const Case& c = case_named("spinning_disc");
  const ExactMotion exact = c.exact(c.t_end);
  const double stop = exact.pieces[1].begin, R_e = 0.2 / 3;
  const auto ratio = [&](double t) {
    const VecX v = evaluate(exact, t).v;
    return std::pair{v[0], v[1] / 0.1 * R_e};
  };
  for (const double t : {0.1 * stop, 0.5 * stop, 0.9 * stop}) {
    const auto [slip, drilling] = ratio(t);
    EXPECT_NEAR(std::log(drilling / (10 * R_e)) / std::log(slip), 8.0 / 9, 1e-9);
  }
  const auto [slip, drilling] = ratio(stop * (1 - 1e-9));
  EXPECT_LT(std::hypot(slip, drilling), 1e-7);
  EXPECT_GT(slip, 0);
}

}  // namespace
}  // namespace aussois
