// SPDX-License-Identifier: Apache-2.0
// The event-driven reference on motions that are known exactly: times of events, states at the ends of steps.
#include "integrators/event_driven.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

EventDrivenOptions options(double h, bool certify = false) {
  return {.ode = {.relative = 1e-12, .absolute = 1e-14},
          .step = {.h = h, .solver = {.tolerance = 1e-13}, .advancement = {.certify = certify}}};
}

struct Watched {
  State end{};
  std::vector<StepEvent> events{};
  double q_error = 0, v_error = 0;  // at the ends of steps
  double balance = 0;               // of the energy, worst step [J]
};

/// Steps of h to the end of the case, compared with the exact motion after each.
Watched watch(const Case& c, const EventDrivenOptions& o) {
  const CaseScene scene = c.scene();
  const ExactMotion exact = c.exact(c.t_end);
  const EventDriven scheme(scene.model, o);
  Watched out{.end = scene.state};
  while (out.end.t < c.t_end * (1 - 1e-12)) {
    const StepReport report = scheme.step(out.end, c.t_end - out.end.t);
    EXPECT_TRUE(report.ok()) << c.name << ": " << report.reason << " at t = " << out.end.t;
    if (!report.ok()) break;
    out.events.insert(out.events.end(), report.events.begin(), report.events.end());
    const MotionSample computed = c.observe(scene, out.end), right = evaluate(exact, out.end.t);
    out.q_error = std::max(out.q_error, (computed.q - right.q).norm());
    out.v_error = std::max(out.v_error, (computed.v - right.v).norm());
    out.balance = std::max(out.balance, std::abs(report.energy.residual()));
  }
  return out;
}

class EveryCase : public ::testing::TestWithParam<std::string> {};

// Seven steps and a bit, whatever happens in them. The tolerances of 1e-12 per internal step add up to some
// 1e-9 where friction is stiff and the orbit unstable.
TEST_P(EveryCase, IsExactAtTheEndsOfLongSteps) {
  const Case& c = case_named(GetParam());
  const Watched run = watch(c, options(c.t_end / 7.3));
  EXPECT_LT(run.q_error, 5e-9);
  EXPECT_LT(run.v_error, 5e-9);
  EXPECT_LT(run.balance, 2e-9);
}

// Every piece of the exact motion begins with an event. An impact is located to the error of its gap, some
// 1e-14 m, over its speed; slower ones than 1e-4 m/s are left out here.
TEST_P(EveryCase, HasAllEventsAtTheirTimes) {
  const Case& c = case_named(GetParam());
  const Watched run = watch(c, options(c.t_end / 7.3));
  const ExactMotion exact = c.exact(c.t_end);
  int events = 0;
  for (std::size_t k = 1; k < exact.pieces.size() && exact.pieces[k].begin < c.t_end; ++k) {
    const double t = exact.pieces[k].begin;
    const double jump = (exact.pieces[k].at(t).v - exact.pieces[k - 1].at(t).v).norm();
    if (c.bounces && jump < 1e-4) continue;
    double off = kInf;
    for (const StepEvent& event : run.events) off = std::min(off, std::abs(event.t - t));
    // Redundant contacts share friction as the solver likes: the first to reach its cone lets go, a little
    // early.
    EXPECT_LT(off, c.bounces ? 1e-9 : 5e-8) << "event " << k << " at " << t;
    ++events;
  }
  EXPECT_EQ(events == 0, run.events.empty());
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const Case& c : cases()) out.push_back(c.name);
  return out;
}
INSTANTIATE_TEST_SUITE_P(EventDriven, EveryCase, ::testing::ValuesIn(names()),
                         [](const auto& c) { return c.param; });

// A1. 2 e v / (g (1 - e)) after an impact the last of infinitely many: t = t_1 (1 + e) / (1 - e).
TEST(EventDriven, ForetellsTheEndOfInfinitelyManyImpacts) {
  const Watched run = watch(case_named("ball_e05"), options(1));
  const auto rest =
      std::ranges::find_if(run.events, [](const StepEvent& e) { return e.kind == EventKind::rest; });
  ASSERT_NE(rest, run.events.end());
  EXPECT_NEAR(rest->t, 3 * std::sqrt(2 / 9.81), 1e-8);
  EXPECT_EQ(run.events.size(), 19u);  // 18 impacts that leave faster than 1e-5 m/s, and the rest
  EXPECT_LT(run.end.v.norm(), 1e-12);
}

// Kinetic energy and momentum of free tops, over the whole run.
TEST(EventDriven, KeepsTheEnergyOfAFreeTop) {
  for (const char* name : {"free_top", "dzhanibekov"}) {
    const CaseScene scene = case_named(name).scene();
    const Watched run = watch(case_named(name), options(1));
    const double before = energy(scene.model, scene.state).kinetic;
    EXPECT_NEAR(energy(scene.model, run.end).kinetic, before, 2e-10 * before) << name;
    EXPECT_LT((momentum(scene.model, run.end).angular - momentum(scene.model, scene.state).angular).norm(),
              1e-9 * momentum(scene.model, scene.state).angular.norm())
        << name;
  }
}

// The certificate refuses nothing here, and changes nothing: it looks at the path that was found.
TEST(EventDriven, IsProvenNotToPassThroughAnything) {
  for (const char* name : {"ball_e05", "rocking_block", "stick_slip"}) {
    const Case& c = case_named(name);
    const Watched plain = watch(c, options(c.t_end / 7.3)), proven = watch(c, options(c.t_end / 7.3, true));
    EXPECT_EQ(hash(plain.end), hash(proven.end)) << name;
  }
}

// A dilated point that crosses the plate between two internal steps must not be lost: 800 m/s, 40 m a step.
TEST(EventDriven, StopsABulletAtThePlate) {
  CaseScene s = case_named("ball_e1").scene();
  twist(s.state, s.body)[2] = -800;
  const EventDriven scheme(s.model, options(5e-2));
  const double z = pose(s.state, s.body).p.z();
  const StepReport report = scheme.step(s.state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 1u);
  EXPECT_NEAR(report.events[0].t, (std::sqrt(800 * 800 + 2 * 9.81 * z) - 800) / 9.81, 1e-12);
  EXPECT_GT(twist(s.state, s.body)[2], 799);
}

// What the scheme knows between steps stands in the state.
TEST(EventDriven, GivesTheSameBitsWithAFreshSchemeInEachStep) {
  for (const char* name : {"ball_e05", "stick_slip", "heavy_top"}) {
    const Case& c = case_named(name);
    const CaseScene s = c.scene();
    const EventDrivenOptions o = options(c.t_end / 7.3);
    const EventDriven kept(s.model, o);
    State one = s.state, other = s.state;
    for (int k = 0; k < 4; ++k) {
      ASSERT_TRUE(kept.step(one).ok());
      ASSERT_TRUE(EventDriven(s.model, o).step(other).ok());
      EXPECT_EQ(hash(one), hash(other)) << name << ", step " << k;
    }
  }
}

/// B9. A rod of 1 kg and half length 1 m in the plane (x, y, angle from the ground), its lower left end on
/// the ground.
Model rod(double mu) {
  Model model;
  add(model, Coordinates{.name = "rod",
                         .size = 3,
                         .mass = [](const VecX&) -> MatX { return Vec3(1, 1, 1.0 / 3).asDiagonal(); },
                         .force = [](double, const VecX&,
                                     const VecX&) { return CoordinateForce{.f = Vec3(0, -9.81, 0)}; },
                         .potential = [](const VecX& q) { return 9.81 * q[1]; }});
  add(model, GapFunction{.name = "end",
                         .block = 0,
                         .evaluate =
                             [](const Model&, const State& s, double) {
                               const double phi = s.q[2];
                               GapRows out{.gap = s.q[1] - std::sin(phi), .J = MatX(2, 3)};
                               out.J << 0, 1, -std::cos(phi), 1, 0, std::sin(phi);
                               return out;
                             },
                         .law = {.mu = mu}});
  return model;
}

// No finite force keeps the end on the ground: the impulse (0.375, 0.625) does, to the push that finds it.
TEST(EventDriven, JumpsWhereNoForceKeepsAContactClosed) {
  for (const double speed : {1.0, 0.1, 0.01}) {
    const Model model = rod(2);
    State state = rest_state(model);
    state.q << 0, std::sin(kPi / 4), kPi / 4;
    state.v << -speed, 0, 0;
    const StepReport report = EventDriven(model, options(1e-6)).step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    ASSERT_EQ(report.events.size(), 1u);
    EXPECT_EQ(report.events[0].kind, EventKind::tangential_impact);
    EXPECT_NEAR(state.r[0], 0.375 * speed, 1e-5);  // gravity acts for 1e-6 s
    EXPECT_NEAR(state.r[1], 0.625 * speed, 1e-5);
    EXPECT_NEAR(state.v[0], -0.375 * speed, 1e-5);
    EXPECT_NEAR(state.v[1], 0.375 * speed, 2e-5);
    EXPECT_NEAR(state.v[2], 0.530330 * speed, 1e-5);
  }
}

// With less friction the same rod slides on.
TEST(EventDriven, SlidesWhereAForceDoes) {
  const Model model = rod(0.5);
  State state = rest_state(model);
  state.q << 0, std::sin(kPi / 4), kPi / 4;
  state.v << -1, 0, 0;
  const StepReport report = EventDriven(model, options(1e-3)).step(state);
  ASSERT_TRUE(report.ok()) << report.reason;
  EXPECT_TRUE(report.events.empty());
  EXPECT_GT(state.r[0], 0);
  EXPECT_NEAR(state.r[1], 0.5 * state.r[0], 1e-12);
}

// A wall lets go of the slider-crank again and again, at gaps that are rounding of either sign, each time of
// both corners: 0.2 s, the closed motion of C2 at the end of each step.
TEST(EventDriven, LeavesAWallFromAnOverlapOfRounding) {
  const CaseScene s = slider_crank_of_angles(0);
  const ExactMotion exact = slider_crank_motion(0.2);
  const EventDriven scheme(s.model, options(1e-3));
  State state = s.state;
  int releases = 0, hits = 0;
  while (state.t < 0.2 - 1e-12) {
    const StepReport report = scheme.step(state, 0.2 - state.t);
    ASSERT_TRUE(report.ok()) << report.reason;
    for (const StepEvent& e : report.events) {
      releases += e.kind == EventKind::release;
      hits += e.kind == EventKind::impact && e.speed > 0.02;
    }
    EXPECT_LT((slider_of_angles(s, state).q - evaluate(exact, state.t).q).norm(), 2e-8) << state.t;
  }
  EXPECT_GT(releases, 10);
  EXPECT_EQ(hits, 2 * 43);  // both corners
}

/// 1 kg on a slide along z, which pulls down by gravity if `falls`.
CaseScene slide(bool falls) {
  CaseScene s;
  s.model.gravity = Vec3(0, 0, falls ? -9.81 : 0);
  s.body = add(s.model, RigidBody{.name = "slider", .mass = 1, .inertia = 1e-2 * Mat3::Identity()});
  s.state = rest_state(s.model);
  add(s.model, joint_at(JointKind::prismatic, "slide", s.body, -1, s.state.g, SE3{}));
  return s;
}

// A stop 1 m below: the impacts of A1.
TEST(EventDriven, BouncesFromTheStopOfAJoint) {
  CaseScene s = slide(true);
  s.model.joints[0].axis[0].lower = -1;
  s.model.joints[0].axis[0].restitution = 0.5;
  const StepReport report = EventDriven(s.model, options(1.2)).step(s.state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 3u);
  const double first = std::sqrt(2 / 9.81);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(report.events[std::size_t(k)].t, first * (3 - 2 * std::pow(0.5, k)), 1e-9);
  EXPECT_LT(std::abs(report.energy.residual()), 1e-9);
}

// Dry friction of 2 N takes 1 m/s away in half a second and a quarter of a metre, then holds.
TEST(EventDriven, StopsWhereDryFrictionSays) {
  CaseScene s = slide(false);
  s.model.joints[0].axis[0].friction = 2;
  twist(s.state, s.body)[2] = 1;
  const StepReport report = EventDriven(s.model, options(1)).step(s.state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 1u);
  EXPECT_EQ(report.events[0].kind, EventKind::stick);
  EXPECT_NEAR(report.events[0].t, 0.5, 1e-9);
  EXPECT_NEAR(pose(s.state, s.body).p.z(), 0.25, 1e-9);
  EXPECT_NEAR(report.energy.joint_work, -0.5, 1e-9);
}

// All contacts of a face end their slip at once, up to rounding: neither it nor the tolerance decides.
TEST(EventDriven, TurnsAFaceBackWhateverTheTolerance) {
  const Case& c = case_named("incline_30_up");
  for (const double factor : {0.5, 0.9, 1.01, 1.1, 3.0}) {
    EventDrivenOptions o = options(c.t_end / 7.3);
    o.ode.relative *= factor, o.ode.absolute *= factor;
    const Watched run = watch(c, o);
    EXPECT_LT(run.q_error, 5e-9) << factor;
    EXPECT_LT(run.v_error, 5e-9) << factor;
  }
}

TEST(EventDriven, RefusesMoreEventsThanAllowed) {
  CaseScene s = case_named("ball_e05").scene();
  EventDrivenOptions o = options(2);
  o.max_events = 5;
  const std::uint64_t before = hash(s.state);
  const StepReport report = EventDriven(s.model, o).step(s.state);
  EXPECT_EQ(report.status, StepStatus::refused);
  EXPECT_NE(report.reason.find("more than 5 events"), std::string::npos) << report.reason;
  EXPECT_EQ(hash(s.state), before);
}

TEST(EventDriven, RefusesBadOptionsAtTheDoor) {
  const CaseScene s = case_named("heavy_top").scene();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* field;  // as the message begins
    std::vector<double> values;
    void (*set)(EventDrivenOptions&, double);
  } table[] = {
      {"OdeOptions::relative", {0, 1, nan}, [](auto& o, double x) { o.ode.relative = x; }},
      {"OdeOptions::absolute", {-1, 0, kInf, nan}, [](auto& o, double x) { o.ode.absolute = x; }},
      {"OdeOptions::largest_step", {0, nan}, [](auto& o, double x) { o.ode.largest_step = x; }},
      {"OdeOptions::max_steps", {0}, [](auto& o, double x) { o.ode.max_steps = long(x); }},
      {"EventDrivenOptions::horizon", {0, nan}, [](auto& o, double x) { o.horizon = x; }},
      {"EventDrivenOptions::gap_tolerance", {0, 1, nan}, [](auto& o, double x) { o.gap_tolerance = x; }},
      {"EventDrivenOptions::rest_speed", {0, nan}, [](auto& o, double x) { o.rest_speed = x; }},
      {"EventDrivenOptions::stick_speed", {0, nan}, [](auto& o, double x) { o.stick_speed = x; }},
      {"EventDrivenOptions::stiff_slip", {-1, nan}, [](auto& o, double x) { o.stiff_slip = x; }},
      {"EventDrivenOptions::max_events", {0}, [](auto& o, double x) { o.max_events = int(x); }},
      {"StepOptions::h", {0, nan}, [](auto& o, double x) { o.step.h = x; }},
  };
  for (const auto& bad : table)
    for (const double value : bad.values) {
      EventDrivenOptions o = options(1e-2);
      bad.set(o, value);
      std::ostringstream begin;
      begin << bad.field << " = " << value << " must ";
      const std::string message = message_of([&] { EventDriven(s.model, o); });
      EXPECT_EQ(message.find(begin.str()), 0U) << begin.str() << '\n' << message;
    }
  Model model = s.model;
  model.joints[0] = Joint{.name = "motor", .kind = JointKind::revolute, .body_a = 0};
  model.joints[0].axis[0].motor = {
      .kind = MotorKind::speed, .target = [](double) { return 1.0; }, .limit = 2};
  EXPECT_THROW(EventDriven(model, options(1e-2)), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
