// SPDX-License-Identifier: Apache-2.0
// Facts of single cases that hold to rounding, or to one step: impacts, friction, rolling, rocking, tops.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/study.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81;

SchemeOptions options(double h, double theta, NormalLaw law) {
  return {.h = h,
          .theta = theta,
          .normal = {.law = law},
          .solver = {.tolerance = 1e-13},
          .advancement = {.certify = false}};
}

/// Steps of `name` from the scene's state to t_end; `after` sees the state after each.
State run(const CaseScene& scene, const SchemeOptions& o, double t_end,
          const std::function<void(const State&)>& after = {}) {
  const Scheme scheme = make_scheme("moreau_jean", scene.model, o);
  State state = scene.state;
  while (state.t < t_end * (1 - 1e-12)) {
    const StepReport report = scheme.step(state, t_end - state.t);
    EXPECT_TRUE(report.ok()) << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
    if (after) after(state);
  }
  return state;
}

// A1, e = 1. The step of an impact at the midpoint turns the velocity and leaves the height.
TEST(BouncingBall, KeepsItsEnergyToRoundingAtTheMidpoint) {
  const CaseScene s = case_named("ball_e1").scene();
  const double before = energy(s.model, s.state).total();
  run(s, options(1e-2, 0.5, NormalLaw::moreau), 20,
      [&](const State& state) { ASSERT_NEAR(energy(s.model, state).total(), before, 1e-12 * before); });
}

// Implicit Euler loses m (g h)^2 / 2 in each step of a flight.
TEST(BouncingBall, LosesTheEnergyOfImplicitEulerInFlight) {
  const CaseScene s = case_named("ball_e1").scene();
  const double h = 1e-2;
  const State state = run(s, options(h, 1, NormalLaw::moreau), 0.4);  // 40 steps, before the first impact
  EXPECT_NEAR(energy(s.model, s.state).total() - energy(s.model, state).total(),
              40 * std::pow(kGravity * h, 2) / 2, 1e-12);
}

// After the accumulation point the ball rests: what is left are the steps of Newton's law on the last g h.
TEST(BouncingBall, RestsAfterItsAccumulationPoint) {
  const double h = 1e-3, impact_speed = std::sqrt(2 * kGravity);
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined}) {
    const CaseScene s = case_named("ball_e05").scene();
    const State state = run(s, options(h, 0.5, law), 3);
    EXPECT_LT(std::abs(twist(state, s.body)[2]), 1e-12) << to_string(law);
    EXPECT_LT(std::abs(pose(state, s.body).p.z()), impact_speed * h) << to_string(law);
  }
}

// A3. The orbit at W = 2.6 is stable: errors shrink by 0.8 in each period. Those at 2.8 and 4.6 multiply them
// by 3 and 35, so a hundred periods there are beyond 16 digits. h = T / 1000.
TEST(ForcedOscillator, HoldsItsStableOrbitForAHundredPeriods) {
  const Case& c = case_named("forced_26");
  const CaseScene s = c.scene();
  const ExactMotion orbit = c.exact(c.t_end);
  const double period = orbit.pieces[2].begin - orbit.pieces[1].begin;
  const double wanted = orbit.pieces[0].at(orbit.pieces[1].begin).v[0];  // before the impact
  double before = 0;
  std::vector<double> hits, times;
  run(s, options(period / 1000, 0.5, NormalLaw::combined), 100 * period, [&](const State& state) {
    const double v = twist(state, s.body)[2];
    if (before < 0 && v > 0) hits.push_back(before), times.push_back(state.t);
    before = v;
  });
  ASSERT_EQ(hits.size(), 100u);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(hits[k], wanted, 1e-2 * std::abs(wanted)) << "impact " << k;
    EXPECT_NEAR(times[k], (double(k) + 0.5) * period, 3e-3 * period) << "impact " << k;  // three steps
  }
}

// A4. Newton's law on all contacts at once; the sequential rule would give (0, 0, 1).
TEST(Cradle, OfThreeBallsFollowsTheSimultaneousLaw) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0, .restitution = 1};
  const int ball = add(s.model, prepare(dilate(make_point(), 0.05)));
  for (int i = 0; i < 3; ++i)
    add(s.model, RigidBody{.name = "ball", .shape = ball, .mass = 1, .inertia = 1e-3 * Mat3::Identity()});
  s.state = rest_state(s.model);
  for (int i = 0; i < 3; ++i) pose(s.state, i).p.x() = i * (0.1 - 1e-15);
  twist(s.state, 0)[0] = 1;
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined}) {
    const State state = run(s, options(1e-3, 0.5, law), 1e-3);
    EXPECT_NEAR(twist(state, 0)[0], -1.0 / 3, 1e-12) << to_string(law);
    EXPECT_NEAR(twist(state, 1)[0], 2.0 / 3, 1e-12) << to_string(law);
    EXPECT_NEAR(twist(state, 2)[0], 2.0 / 3, 1e-12) << to_string(law);
  }
}

// B1. A cone, not a pyramid: the way down does not depend on where the slope points, nor on how the block is
// turned.
TEST(Incline, LooksTheSameFromEveryDirection) {
  const CaseScene along_x = case_named("incline_30").scene();
  const SchemeOptions o = options(5e-3, 0.5, NormalLaw::combined);
  const double way = pose(run(along_x, o, 0.5), along_x.body).p.x();
  for (const double turn : {0.0, kPi / 4})
    for (const double direction : {kPi / 4, 1.0}) {
      CaseScene s = case_named("incline_30").scene();
      s.model.gravity = rotation(Vec3::UnitZ(), direction) * s.model.gravity;
      pose(s.state, s.body).R = rotation(Vec3::UnitZ(), turn).R;
      const Vec3 p = pose(run(s, o, 0.5), s.body).p;
      EXPECT_NEAR(p.x(), way * std::cos(direction), 1e-9);
      EXPECT_NEAR(p.y(), way * std::sin(direction), 1e-9);
    }
}

// B2. Slip begins, turns and ends within three steps of the exact instants.
TEST(StickSlip, ChangesAtTheRightSteps) {
  const double h = 1e-3;
  for (const char* name : {"stick_slip", "reversal"}) {
    const CaseScene s = case_named(name).scene();
    const ExactMotion exact = case_named(name).exact(5);
    std::vector<double> changes;  // of the direction of slip; 0: stick
    int direction = 0;
    run(s, options(h, 0.5, NormalLaw::combined), 5, [&](const State& state) {
      const double v = twist(state, s.body)[0];
      const int now = v > 1e-6 ? 1 : v < -1e-6 ? -1 : 0;
      if (now != 0 && now != direction) changes.push_back(state.t), direction = now;
    });
    ASSERT_EQ(changes.size(), exact.pieces.size() - 1) << name;
    for (std::size_t k = 0; k < changes.size(); ++k)
      EXPECT_NEAR(changes[k], exact.pieces[k + 1].begin, 3 * h) << name;
  }
}

// B3. Friction is constant while the sphere slips: with a step that divides t*, nothing is left but rounding.
TEST(Rolling, BeginsExactlyIfItBeginsWithAStep) {
  for (const char* name : {"bowling", "back_spin", "side_spin"}) {
    const Case& c = case_named(name);
    const CaseScene s = c.scene();
    const ExactMotion exact = c.exact(c.t_end);
    const State state = run(s, options(exact.pieces[1].begin / 50, 1, NormalLaw::combined), c.t_end);
    const VecX v = c.observe(s, state).v, expected = evaluate(exact, c.t_end).v;
    EXPECT_LT((v - expected).norm(), 1e-12 * expected.norm()) << name;
    EXPECT_NEAR(v[5], expected[5], 1e-12) << name << ": the pivot spin";
  }
}

// B9. A rod slides on its tip, mu = 2 above the critical 1.3: no force is consistent with sliding on in the
// direction that digs the tip in, an impulse is, (0.375, 0.625) N s. In the other direction it slides on.
TEST(Painleve, StopsTheTipByAnImpactWithoutCollision) {
  const double J = 1.0 / 3;
  CaseScene s;
  s.model.contact_law = {.mu = 2, .restitution = 0};
  const int plate = add(s.model, prepare(dilate(make_plate(4, 4), 0.05)));
  const int rod = add(s.model, prepare(dilate(make_segment(2), 0)));
  add(s.model, fixed_body("plate", plate));
  s.body = add(s.model,
               RigidBody{.name = "rod", .shape = rod, .mass = 1, .inertia = Vec3(1e-6, J, J).asDiagonal()});
  s.state = rest_state(s.model);
  pose(s.state, s.body).R = rotation(Vec3::UnitY(), -kPi / 4).R;  // its tip at -x, rising towards +x
  pose(s.state, s.body).p = Vec3(0, 0, 0.05 - 1e-14 + std::sin(kPi / 4));
  for (const double h : {1e-4, 1e-5, 1e-6})
    for (const double speed : {1.0, 0.1, 0.01}) {  // the jump goes with it; gravity adds 7.4 m/s^2 h
      const auto after = [&](double v) {
        twist(s.state, s.body)[0] = v;
        return Vec6(twist(run(s, options(h, 0.5, NormalLaw::moreau), h), s.body));
      };
      Vec6 stopped, slid;
      stopped << -0.375, 0, 0.375, 0, -0.375 * std::sqrt(2.0), 0;
      slid << 1, 0, 0, 0, 0, 0;
      EXPECT_LT((after(-speed) - speed * stopped).norm(), 8 * h) << speed;
      EXPECT_LT((after(speed) - speed * slid).norm(), 20 * h) << speed;
    }
}

// C1. The impact itself, without gravity: upright, about to change the edge. Housner's ratio is exact.
TEST(RockingBlock, PassesOnHousnersPartOfItsSpeed) {
  const double ratio = 1 - 1.5 / 17;  // sin^2 alpha = 0.05^2 / (0.05^2 + 0.2^2) = 1/17
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined, NormalLaw::gap_over_step}) {
    CaseScene s = case_named("rocking_block").scene();
    s.model.gravity = Vec3::Zero();
    SE3& g = pose(s.state, s.body);
    const double height = 0.2, width = 0.05, omega = -1.2;  // about the edge at +x, its foot at -x comes down
    g = translation(0, 0, 1e-2 + height - 1e-14);
    twist(s.state, s.body) << Vec3(0, omega, 0).cross(Vec3(-width, 0, height)), Vec3(0, omega, 0);
    const State state = run(s, options(1e-4, 0.5, law), 1e-4);
    EXPECT_NEAR(twist(state, s.body)[4], ratio * omega, 1e-9) << to_string(law);
  }
}

// D1. 3e-10 from the separatrix: only a scheme that hardly changes energy and momentum flips at the right
// times. Of order two in h.
TEST(Dzhanibekov, FlipsAtTheRightTime) {
  CaseScene s = case_named("dzhanibekov").scene();
  twist(s.state, s.body).tail<3>() = Vec3(0, 2, 1e-4);
  for (const double h : {5e-3, 2.5e-3, 1e-3}) {
    double flip = 0, before = 2;
    run(s, options(h, 0.5, NormalLaw::moreau), 7, [&](const State& state) {
      const double w = twist(state, s.body)[4];
      if (flip == 0 && w < 0) flip = state.t - h * w / (w - before);
      before = w;
    });
    EXPECT_NEAR(flip, 6.18519931, 2 * h * h);  // a quarter of the period of the Jacobi functions
  }
}

// D2.
TEST(FreeTop, IsRightToAMillionthAtAMillisecond) {
  const Case& c = case_named("free_top");
  const CaseScene s = c.scene();
  const State state = run(s, options(1e-3, 0.5, NormalLaw::moreau), c.t_end);
  EXPECT_LT((c.observe(s, state).v - evaluate(c.exact(c.t_end), c.t_end).v).norm(), 1e-6);
}

}  // namespace
}  // namespace aussois
