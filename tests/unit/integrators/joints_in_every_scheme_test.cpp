// SPDX-License-Identifier: Apache-2.0
// Joints, stops, friction, springs and motors in every scheme and setting, in maximal coordinates and in
// those of the joints, against the closed forms that mechanism_test.cpp holds Moreau-Jean to.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/tumbling.hpp"
#include "geometry/primitives.hpp"
#include "mechanics/tree.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/one_axis.hpp"
#include "tests/support/scheme_variants.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kPull = 9.81;

constexpr JointKind kKinds[] = {JointKind::fixed,       JointKind::revolute,  JointKind::prismatic,
                                JointKind::cylindrical, JointKind::spherical, JointKind::universal,
                                JointKind::planar,      JointKind::screw,     JointKind::distance};

struct Setting {
  SchemeVariant scheme{};
  bool in_trees = false;  // joints that have coordinates are (TREE-1)
};
// The midpoint rule has no trees.
std::vector<Setting> settings() {
  std::vector<Setting> out;
  for (const SchemeVariant& v : variants_with_joints()) {
    out.push_back({v, false});
    if (v.name != "passive_midpoint") out.push_back({v, true});
  }
  return out;
}

class EverySchemeAndJoint : public ::testing::TestWithParam<Setting> {
 protected:
  const SchemeVariant& v = GetParam().scheme;
  const bool in_trees = GetParam().in_trees;
  const bool event_driven = v.name == "event_driven", paoli = v.name == "schatzman_paoli",
             alpha = v.name == "generalised_alpha", mean_joints = v.options.passive_midpoint.mean_joints,
             cayley = v.options.step.update == GroupUpdate::cayley,
             first_order = scheme_traits(v.name, v.options).smooth < 2,
             stops_bounce = scheme_traits(v.name, v.options).restitution;
  // What a plastic stop is left with: only the midpoint rule pushes an overlap out, and may keep that speed.
  const double pushed_out = v.name == "passive_midpoint" ? StepOptions{}.correction_speed : 0;

  Scheme scheme(const Model& model, double h) const {
    SchemeOptions o = v.options;
    o.step.h = h;
    return make_scheme(v.name, model, o);
  }
  void choose_coordinates(Model& model, State& state, const std::vector<JointId>& joints = {0}) const {
    if (!in_trees) return;
    for (const JointId j : joints) add_tree(model, "tree " + to_string(j), {j});
    state = in_joint_coordinates(model, state);
  }
};

// Two free bodies that tumble on each joint: it holds to rounding, and so does their momentum in maximal
// coordinates. Energy, and momentum in those of the joint, by the order of the scheme; energy exactly on mean
// joints, but for screws.
TEST_P(EverySchemeAndJoint, HoldsWhateverItsKind) {
  for (const JointKind kind : kKinds) {
    if (in_trees && axis_count(kind) == 0) continue;
    SCOPED_TRACE(to_string(kind));
    const auto tumble = [&](double h, double& energy_off, double& momentum_off) {
      auto [model, state] = Tumbling(kind);
      choose_coordinates(model, state);
      const double E = energy(model, state).total();
      const Vec3 p = momentum(model, state).linear;
      double pushed = 0;
      advance(scheme(model, h), state, 0.1, [&](const StepReport& report) {
        EXPECT_LT(report.joint_error.translation + report.joint_error.rotation, 1e-13);
        pushed = std::max(pushed, report.joints[0].force.norm());
      });
      EXPECT_TRUE(in_trees || pushed > 0.05);
      energy_off = std::abs(energy(model, state).total() / E - 1);
      momentum_off = (momentum(model, state).linear - p).norm();
    };
    double energy_off = 0, momentum_off = 0, half_energy_off = 0, half_momentum_off = 0;
    tumble(in_trees ? 5e-4 : 2e-3, energy_off, momentum_off);
    if (!in_trees) {
      EXPECT_LT(momentum_off, 1e-13);
      const double within = first_order                               ? 2e-4
                            : alpha                                   ? 6e-6
                            : mean_joints && kind != JointKind::screw ? 1e-14
                                                                      : 1e-7;
      EXPECT_LT(energy_off, within);
      continue;
    }
    tumble(2.5e-4, half_energy_off, half_momentum_off);
    const double falls = std::pow(0.5, first_order ? 0.9 : 1.85);
    EXPECT_LT(half_momentum_off, std::max(falls * momentum_off, 1e-9));
    EXPECT_LT(half_energy_off, std::max(falls * energy_off, 1e-8));
  }
}

// Between stops with e = 0.8, or onto a plastic one where the scheme knows no restitution: up to a step of
// way beyond them. That of Schatzman and Paoli takes two steps.
TEST_P(EverySchemeAndJoint, TurnsBackAtItsStops) {
  const double h = 1e-3;
  OneAxis s(JointKind::prismatic);
  s.axis() = {.lower = -0.1, .upper = 0.2, .restitution = stops_bounce ? 0.8 : 0};
  s.state.v[0] = 1;
  choose_coordinates(s.model, s.state);
  int impacts = 0, checked = 0;
  double before = s.speed();
  advance(scheme(s.model, h), s.state, 1, [&](const StepReport&) {
    if (s.speed() * before < 0) ++impacts;
    if (stops_bounce && (!paoli || std::abs(s.speed() - before) < 1e-12)) {
      ++checked;
      EXPECT_NEAR(std::abs(s.speed()), std::pow(0.8, impacts), 1e-12);
    }
    before = s.speed();
    EXPECT_GT(s.q(), -0.1 - h);
    EXPECT_LT(s.q(), 0.2 + h);
  });
  if (stops_bounce) {
    EXPECT_EQ(impacts, 2);
    EXPECT_GT(checked, event_driven ? 0 : 900);
  } else {
    EXPECT_NEAR(s.q(), 0.2, h + 0.8 * pushed_out);
    EXPECT_LT(std::abs(s.speed()), pushed_out + 1e-12);
  }
}

// 5 pi away, at 25 rad/s.
TEST_P(EverySchemeAndJoint, StopsAfterTwoTurnsAndAHalf) {
  const double h = 1e-2;
  OneAxis w(JointKind::revolute);
  w.axis() = {.lower = -1, .upper = 5 * kPi};
  w.axis().motor = {.kind = MotorKind::effort, .target = [](double) { return 10; }};
  choose_coordinates(w.model, w.state);
  advance(scheme(w.model, h), w.state, 3);
  EXPECT_NEAR(w.q(), 5 * kPi, 25 * h);
  EXPECT_LT(std::abs(w.speed()), pushed_out + 1e-12);
}

// 2 m/s^2 of dry friction bring 1 m/s to rest in half a second, and hold 1.9 m/s^2.
TEST_P(EverySchemeAndJoint, IsStoppedAndHeldByDryFriction) {
  const double h = 1e-2;
  OneAxis s(JointKind::prismatic, 2);
  s.axis().friction = 4;
  s.state.v[0] = 1;
  choose_coordinates(s.model, s.state);
  const Scheme step = scheme(s.model, h);
  advance(step, s.state, 0.49, [](const StepReport& r) { EXPECT_NEAR(r.joints[0].effort[0], -4, 1e-11); });
  EXPECT_NEAR(s.speed(), paoli ? 0.03 : 0.02, 1e-12);  // half a step old (SP-2)
  advance(step, s.state, 1, [&](const StepReport& r) { EXPECT_LE(r.energy.joint_work, 1e-15); });
  EXPECT_NEAR(s.speed(), 0, 1e-12);
  EXPECT_NEAR(s.q(), 0.25, first_order ? 0.51 * h : 1e-12);
  s.model.gravity = Vec3(1.9, 0, 0);
  const double q = s.q();
  advance(scheme(s.model, h), s.state, 2);
  EXPECT_NEAR(s.speed(), 0, 1e-12);
  EXPECT_NEAR(s.q(), q, alpha ? 1e-6 : 1e-12);
}

TEST_P(EverySchemeAndJoint, SwingsOnItsSpringAndDamperToItsOrder) {
  const auto error = [&](double h) {
    OneAxis w(JointKind::revolute);
    w.axis() = {.stiffness = 50, .damping = 0.3, .rest = 2 * kPi};  // a full turn away
    choose_coordinates(w.model, w.state);
    advance(scheme(w.model, h), w.state, 1);
    const double b = 0.3 / (2 * 0.5), f = std::sqrt(50 / 0.5 - b * b), t = 1;
    return std::abs(w.q() - 2 * kPi * (1 - std::exp(-b * t) * (std::cos(f * t) + b / f * std::sin(f * t))));
  };
  const double fine = error(2e-3);
  EXPECT_LT(fine, event_driven ? 1e-8 : first_order ? 0.4 : 1e-2);
  if (!event_driven) {
    EXPECT_GT(std::log2(error(4e-3) / fine), (first_order ? 1 : 2) - 0.15);
  }
}

TEST_P(EverySchemeAndJoint, FollowsItsMotors) {
  const double h = event_driven ? 0.25 : 1e-2;
  OneAxis effort(JointKind::revolute);  // 3 t on 1/2 kg m^2
  effort.axis().motor = {.kind = MotorKind::effort, .target = [](double t) { return 3 * t; }};
  choose_coordinates(effort.model, effort.state);
  advance(scheme(effort.model, h), effort.state, 1);
  EXPECT_NEAR(effort.speed(), 3, first_order ? 3.1 * h : alpha ? 3.1 * h * h : 1e-10);
  EXPECT_NEAR(effort.q(), 1, first_order ? 3.1 * h : 3.6 * h * h);

  OneAxis speed(JointKind::revolute);
  speed.axis().motor = {.kind = MotorKind::speed, .target = [](double t) { return std::sin(t); }};
  choose_coordinates(speed.model, speed.state);
  advance(scheme(speed.model, h), speed.state, 0.5,
          [&](const StepReport&) { EXPECT_NEAR(speed.speed(), std::sin(speed.state.t), 1e-12); });
  EXPECT_NEAR(speed.q(), 1 - std::cos(0.5), first_order ? h / 2 : h * h);

  OneAxis position(JointKind::revolute);
  position.axis().motor = {.kind = MotorKind::position,
                           .target = [](double t) { return 20 * (1 - std::cos(t)); }};
  choose_coordinates(position.model, position.state);
  advance(scheme(position.model, h), position.state, 3, [&](const StepReport&) {
    EXPECT_NEAR(position.q(), 20 * (1 - std::cos(position.state.t)), 1e-12);
  });
  EXPECT_GT(position.q(), 6 * 2 * kPi);  // six turns
  EXPECT_NEAR(position.speed(), 20 * std::sin(3), mean_joints ? 3 * h * h : 1e-8);
}

// Full torque up to its speed, and no more. From event to event there is no such law, and the door says so.
TEST_P(EverySchemeAndJoint, FollowsALimitedMotorOrRefusesIt) {
  const double h = 1e-2;
  OneAxis w(JointKind::revolute);
  w.axis().motor = {.kind = MotorKind::speed, .target = [](double) { return 4; }, .limit = 5};
  choose_coordinates(w.model, w.state);
  if (event_driven) {
    EXPECT_NE(message_of([&] { scheme(w.model, h); }).find("a motor of speed or position with a limit"),
              std::string::npos);
    return;
  }
  const Scheme step = scheme(w.model, h);
  advance(step, w.state, 0.3);
  EXPECT_NEAR(w.speed(), 5 / 0.5 * (paoli ? 0.3 - h / 2 : 0.3), 1e-12);
  advance(step, w.state, 0.5);
  EXPECT_NEAR(w.speed(), 4, 1e-12);
}

// What a constant acceleration leaves: nothing, or the half step by which speeds are old (SP-2), or the angle
// that Cayley's map falls short, (h omega)^2 / 12 of it, or the first order of theta = 1.
TEST_P(EverySchemeAndJoint, TurnsTwoWheelsByTheirGears) {
  const double h = 1e-2, t = 2;
  Model model;
  model.gravity = Vec3::Zero();
  for (const double J : {0.5, 3.0})
    add(model, RigidBody{.name = "wheel", .mass = 1, .inertia = J * Mat3::Identity()});
  State state = rest_state(model);
  state.g[1].p.x() = 1;
  add(model, joint_at(JointKind::revolute, "first", 0, kWorld, state.g, kAboutY));
  add(model, joint_at(JointKind::revolute, "second", 1, kWorld, state.g, translation(1, 0, 0) * kAboutY));
  add(model, Coupling{.name = "gears", .joint_1 = 0, .joint_2 = 1, .ratio = -2.5});
  model.joints[0].axis[0].motor = {.kind = MotorKind::effort, .target = [](double) { return 7; }};
  choose_coordinates(model, state, {0, 1});
  const double acceleration = 7 / (0.5 + 3.0 / (2.5 * 2.5));
  advance(scheme(model, h), state, t, [&](const StepReport&) {
    EXPECT_NEAR(joint_coordinate(model, state, 0), -2.5 * joint_coordinate(model, state, 1), 1e-13);
  });
  EXPECT_NEAR(joint_speed(model, state, 0), acceleration * t,
              paoli         ? 0.51 * acceleration * h
              : mean_joints ? 1e-2
                            : 1e-12);
  EXPECT_NEAR(joint_coordinate(model, state, 0), acceleration * t * t / 2,
              first_order && !paoli ? 1.01 * acceleration * t * h / 2
              : cayley              ? 7.2e-3
                                    : 1e-7);
}

TEST_P(EverySchemeAndJoint, RunsDownItsThread) {
  const double h = 1e-2, t = 2;
  Model model;
  add(model, RigidBody{.name = "nut", .mass = 2, .inertia = 0.01 * Mat3::Identity()});
  State state = rest_state(model);
  add(model, Joint{.name = "thread", .kind = JointKind::screw, .body_a = 0, .pitch = 0.1});
  choose_coordinates(model, state);
  const double lead = 0.1 / (2 * kPi), acceleration = kPull * 2 / (2 + 0.01 / (lead * lead));
  advance(scheme(model, h), state, t, [&](const StepReport&) {
    EXPECT_NEAR(state.g[0].p.z(), lead * joint_coordinate(model, state, 0), 1e-12);
  });
  EXPECT_LE(state.turns[0], -9);
  EXPECT_NEAR(twist(state, 0)[2], -acceleration * t,
              paoli         ? 0.51 * acceleration * h
              : mean_joints ? 0.026
                            : 1e-12);
  EXPECT_NEAR(state.g[0].p.z(), -acceleration * t * t / 2,
              first_order && !paoli ? 1.01 * acceleration * t * h / 2
              : cayley              ? 0.013
                                    : 1e-9);
}

// Hooke: tan(out) = cos(bend) tan(in), by a universal joint and two hinges, 14 equations for 11 motions.
TEST_P(EverySchemeAndJoint, TurnsAsHookeSays) {
  const double bend = 0.6;
  Model model;
  model.gravity = Vec3::Zero();
  for (int i = 0; i < 2; ++i)
    add(model, RigidBody{.name = "shaft", .mass = 1, .inertia = 0.1 * Mat3::Identity()});
  State state = rest_state(model);
  const SE3 out = rotation(Vec3::UnitX(), bend);
  add(model, joint_at(JointKind::revolute, "in", 0, kWorld, state.g, SE3{}));
  add(model, joint_at(JointKind::revolute, "out", 1, kWorld, state.g, out));
  add(model, Joint{.name = "cross",
                   .kind = JointKind::universal,
                   .body_a = 1,
                   .body_b = 0,
                   .frame_a = out * rotation(Vec3::UnitZ(), kPi / 2),  // its x: across the out shaft
                   .frame_b = rotation(Vec3::UnitY(), kPi / 2)});      // its z: across the in shaft
  model.joints[0].axis[0].motor = {.kind = MotorKind::position, .target = [](double t) { return 2 * t; }};
  choose_coordinates(model, state, {0, 1});
  advance(scheme(model, 1e-2), state, 2, [&](const StepReport&) {
    const double a = joint_coordinate(model, state, 0), b = joint_coordinate(model, state, 1);
    EXPECT_NEAR(a, 2 * state.t, 1e-12);
    EXPECT_NEAR(std::sin(b - std::atan2(std::sin(a) * std::cos(bend), std::cos(a))), 0, 1e-12);
    EXPECT_NEAR(b, a, 0.2);  // turns together
  });
}

// A hinged flap falls on the ground: joints and contacts in one problem. Hinge and ground carry its weight,
// in steps as long as the one before (SP-2).
TEST_P(EverySchemeAndJoint, FallsOnTheGroundOnItsHinge) {
  Model model;
  model.contact_law = {.mu = 0.5};
  const SimplicialComplex box = make_box(0.4, 0.2, 0.05);
  const double radius = 1e-3;
  const ShapeId shape = add(model, prepare(dilate(box, radius)));
  add(model, fixed_body("ground", add(model, prepare(dilate(make_plate(3, 3), radius)))));
  add(model, solid_body("flap", shape, mass_properties(box, 1000)));
  State state = rest_state(model);
  const double height = 0.025 + 2 * radius;
  state.g[1].p.z() = height;
  add(model,
      joint_at(JointKind::revolute, "hinge", 1, kWorld, state.g, translation(-0.3, 0, height) * kAboutY));
  state.g[1] = translation(-0.3, 0, height) * rotation(Vec3::UnitY(), -1) * translation(0.3, 0, 0);
  choose_coordinates(model, state);
  double carried = 0, h = 0;
  advance(scheme(model, 2e-3), state, 0.6, [&](const StepReport& report) {
    EXPECT_LT(report.joint_error.translation, 1e-12);
    EXPECT_GT(report.min_base_distance, 1.8 * radius);
    if (std::abs(report.h - h) < 1e-12) {
      carried = report.joints[0].force.z();
      for (const StepContact& c : report.contacts) carried -= c.impulse.z() / report.h;  // on A, the ground
    }
    h = report.h;
  });
  const double weight = 1000 * 0.4 * 0.2 * 0.05 * kPull;
  EXPECT_NEAR(joint_coordinate(model, state, 0), 0, radius / 10 / 0.5);  // its end is half a metre away
  EXPECT_LT(twist(state, 1).norm(), 1e-9);
  if (in_trees) return;  // what the hinge carries is not computed
  EXPECT_NEAR(carried, weight, (alpha ? 1e-3 : 1e-9) * weight);
}

INSTANTIATE_TEST_SUITE_P(Schemes, EverySchemeAndJoint, ::testing::ValuesIn(settings()), [](const auto& v) {
  return test_name(v.param.scheme) + (v.param.in_trees ? "_in_trees" : "");
});

}  // namespace
}  // namespace aussois
