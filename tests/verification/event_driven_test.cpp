// SPDX-License-Identifier: Apache-2.0
// The event-driven reference: what joints do in it, and what it refuses. Events and states on exact motions
// are rows of the driver `verify`.
#include "integrators/events/event_driven.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

constexpr EventDrivenOptions kFine{.ode = {.relative = 1e-12, .absolute = 1e-14}};
StepOptions options(double h) {
  return {.h = h, .advancement = {.certify = false}};
}

/// 1 kg on a slide along z, which pulls down by gravity if `falls`.
CaseScene slide(bool falls) {
  CaseScene s;
  s.model.gravity = Vec3(0, 0, falls ? -9.81 : 0);
  s.body = add(s.model, RigidBody{.name = "slider", .mass = 1, .inertia = 1e-2 * Mat3::Identity()});
  s.state = rest_state(s.model);
  add(s.model, joint_at(JointKind::prismatic, "slide", s.body, kWorld, s.state.g, SE3{}));
  return s;
}

// A stop 1 m below: the impacts of A1.
TEST(EventDriven, BouncesFromTheStopOfAJoint) {
  CaseScene s = slide(true);
  s.model.joints[0].axis[0].lower = -1;
  s.model.joints[0].axis[0].restitution = 0.5;
  const StepReport report = EventDriven(s.model, options(1.2), kFine).step(s.state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 3u);
  const double first = std::sqrt(2 / 9.81);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(report.events[k].t, first * (3 - 2 * std::pow(0.5, k)), 1e-9);
  EXPECT_LT(std::abs(report.energy.residual()), 1e-9);
  EXPECT_GE(report.solve.iterations + report.solve.newton_iterations, 3) << "of impacts and what comes after";
  EXPECT_LE(report.solve.residual, kFine.tolerance);
}

// Dry friction of 2 N takes 1 m/s away in half a second and a quarter of a metre, then holds.
TEST(EventDriven, StopsWhereDryFrictionSays) {
  CaseScene s = slide(false);
  s.model.joints[0].axis[0].friction = 2;
  twist(s.state, s.body)[2] = 1;
  const StepReport report = EventDriven(s.model, options(1), kFine).step(s.state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 1u);
  EXPECT_EQ(report.events[0].kind, EventKind::stick);
  EXPECT_NEAR(report.events[0].t, 0.5, 1e-9);
  EXPECT_NEAR(pose(s.state, s.body).p.z(), 0.25, 1e-9);
  EXPECT_NEAR(report.energy.joint_work, -0.5, 1e-9);
}

TEST(EventDriven, RefusesMoreEventsThanAllowed) {
  CaseScene s = case_named("ball_e05").scene();
  EventDrivenOptions own = kFine;
  own.max_events = 5;
  const std::uint64_t before = hash(s.state);
  const StepReport report = EventDriven(s.model, options(2), own).step(s.state);
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
      {"OdeOptions::max_steps", {0}, [](auto& o, double x) { o.ode.max_steps = int(x); }},
      {"EventDrivenOptions::horizon", {0, nan}, [](auto& o, double x) { o.horizon = x; }},
      {"EventDrivenOptions::gap_tolerance", {0, 1, nan}, [](auto& o, double x) { o.gap_tolerance = x; }},
      {"EventDrivenOptions::rest_speed", {0, nan}, [](auto& o, double x) { o.rest_speed = x; }},
      {"EventDrivenOptions::stick_speed", {0, nan}, [](auto& o, double x) { o.stick_speed = x; }},
      {"EventDrivenOptions::stiff_slip", {-1, nan}, [](auto& o, double x) { o.stiff_slip = x; }},
      {"EventDrivenOptions::max_events", {0}, [](auto& o, double x) { o.max_events = int(x); }},
  };
  for (const auto& bad : table)
    for (const double value : bad.values) {
      EventDrivenOptions own;
      bad.set(own, value);
      std::ostringstream begin;
      begin << bad.field << " = " << value << " must ";
      const std::string message = message_of([&] { EventDriven(s.model, {}, own); });
      EXPECT_EQ(message.find(begin.str()), 0U) << begin.str() << '\n' << message;
    }
  EXPECT_NE(message_of([&] {
              EventDriven(s.model, {}, {.ode = {.method = OdeMethod::bdf}, .stiff_slip = 0.2});
            }).find("EventDrivenOptions::stiff_slip = 0.2 is read by OdeOptions::method = adams only"),
            std::string::npos);
  Model model = s.model;
  model.joints[0] = Joint{.name = "motor", .kind = JointKind::revolute, .body_a = 0};
  model.joints[0].axis[0].motor = {
      .kind = MotorKind::speed, .target = [](double) { return 1.0; }, .limit = 2};
  EXPECT_THROW(EventDriven(model, options(1e-2), kFine), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
