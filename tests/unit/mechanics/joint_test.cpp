// SPDX-License-Identifier: Apache-2.0
// doc/theory/mechanical_joints.md: rows of joints against central differences on the group, and by hand.
#include "mechanics/joint.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "mechanics/mechanism.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr JointKind kKinds[] = {JointKind::fixed,       JointKind::revolute,  JointKind::prismatic,
                                JointKind::cylindrical, JointKind::spherical, JointKind::universal,
                                JointKind::planar,      JointKind::screw,     JointKind::distance};

// The pose after a twist of a body has acted for a time dt (MEC-1).
SE3 after(const SE3& g, const Vec6& twist, double dt) {
  return {(g.R * exp_so3(dt * twist.tail<3>())).normalized(), g.p + dt * twist.head<3>()};
}

std::vector<JointRow> all_rows(const Joint& joint, const PerBody<SE3>& g) {
  std::vector<JointRow> rows = locked_rows(joint, g);
  for (int i = 0; i < axis_count(joint.kind); ++i) rows.push_back(axis_row(joint, g, i));
  return rows;
}

class JointRows : public ::testing::TestWithParam<unsigned> {};

// Anywhere, not only where the joint holds.
TEST_P(JointRows, AreTheDerivativesOfTheirValues) {
  Random random(GetParam());
  for (const JointKind kind : kKinds)
    for (const auto& [a, b] : {BodyPair{0, 1}, BodyPair{1, -1}, BodyPair{-1, 0}}) {
      const Joint joint{.kind = kind,
                        .body_a = a,
                        .body_b = b,
                        .frame_a = random.pose(1),
                        .frame_b = random.pose(1),
                        .pitch = 0.3,
                        .length = 0.7};
      const PerBody<SE3> g{random.pose(1), random.pose(1)};
      Vec6 twist[2];
      for (Vec6& v : twist) v << random.vector(1), random.vector(1);
      const auto moved = [&](double dt) {
        return all_rows(joint, {after(g[0], twist[0], dt), after(g[1], twist[1], dt)});
      };
      constexpr double kStep = 1e-6;
      const std::vector<JointRow> rows = all_rows(joint, g), plus = moved(kStep), minus = moved(-kStep);
      ASSERT_EQ(int(rows.size()), locked_count(kind) + axis_count(kind));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        double rate = 0;
        if (a >= 0) rate += rows[i].J_a.dot(twist[a.index()]);
        if (b >= 0) rate += rows[i].J_b.dot(twist[b.index()]);
        double change = plus[i].value - minus[i].value;
        change -= 2 * kPi * std::round(change / (2 * kPi));  // across half a turn; other rows change by 1e-5
        const double difference = change / (2 * kStep);
        // angles far from where the joint holds turn fast: their second derivatives go with the square
        EXPECT_NEAR(difference, rate, 1e-8 * (1 + std::abs(rate * rate * rate)))
            << to_string(kind) << " row " << i;
      }
    }
}
INSTANTIATE_TEST_SUITE_P(Seeds, JointRows, ::testing::Range(0u, 50u));

// (MJT-14): over a step of Cayley's map, however long, the row on the mean times the mean velocity is the
// change of the value; and what it does to both bodies about any point is nothing, with the mean arms.
TEST_P(JointRows, OnTheMeanOfBothEndsAreTheirExactChange) {
  Random random(GetParam());
  for (const JointKind kind : kKinds) {
    if (kind == JointKind::screw) continue;  // an angle, which is not bilinear
    const Joint joint{.kind = kind,
                      .body_a = 0,
                      .body_b = 1,
                      .frame_a = random.pose(1),
                      .frame_b = random.pose(1),
                      .length = 0.7};
    PerBody<SE3> start{random.pose(1), random.pose(1)}, end = start;
    PerBody<Vec6> step(2);  // mean twists times h: turns of up to 2 rad
    for (const BodyId i : step.ids()) {
      step[i] << random.vector(1), random.vector(1);
      const Vec3 w = step[i].tail<3>();
      const Mat3 half = skew(w) / 2, cay = (Mat3::Identity() - half).inverse() * (Mat3::Identity() + half);
      end[i] = {Quat(Mat3(start[i].R.toRotationMatrix() * cay)), start[i].p + step[i].head<3>()};
    }
    const std::vector<JointRow> before = locked_rows(joint, start), after = locked_rows(joint, end),
                                mean = locked_rows(joint, JointPoses(start, end));
    for (std::size_t k = 0; k < mean.size(); ++k) {
      double scale = 1;
      if (kind == JointKind::distance) {  // |d|^2 is bilinear; its row is that of the mean d, made a unit
        const auto d = [&](const PerBody<SE3>& g) {
          return Vec3((g[0] * joint.frame_a).p - (g[1] * joint.frame_b).p);
        };
        scale = (d(start) + d(end)).norm() / (d(start).norm() + d(end).norm());
      }
      EXPECT_NEAR(scale * (mean[k].J_a.dot(step[0]) + mean[k].J_b.dot(step[1])),
                  after[k].value - before[k].value, 1e-13)
          << to_string(kind) << " row " << k;
      Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
      for (const BodyId i : start.ids()) {
        const Vec6& J = i == 0 ? mean[k].J_a : mean[k].J_b;
        const Mat3 R = (start[i].R.toRotationMatrix() + end[i].R.toRotationMatrix()) / 2;
        force += J.head<3>();
        moment += ((start[i].p + end[i].p) / 2).cross(Vec3(J.head<3>())) + R * J.tail<3>();
      }
      EXPECT_LT(force.norm() + moment.norm(), 1e-13) << to_string(kind) << " row " << k;
    }
  }
}

TEST(Joint, HoldsWhereItWasMade) {
  Random random(7);
  const PerBody<SE3> g{random.pose(1), random.pose(1)};
  for (const JointKind kind : kKinds) {
    if (kind == JointKind::distance) continue;
    Joint joint = joint_at(kind, "j", 0, 1, g, random.pose(1));
    joint.pitch = 0.1;
    for (const JointRow& row : all_rows(joint, g)) EXPECT_NEAR(row.value, 0, 1e-15) << to_string(kind);
  }
}

TEST(Joint, LockedRowsAreIndependentAndLeaveTheFreeMotions) {
  Random random(8);
  for (const JointKind kind : kKinds) {
    const PerBody<SE3> g{random.pose(1)};
    Joint joint = joint_at(kind, "j", 0, kWorld, g, random.pose(1));
    joint.pitch = 0.1;
    joint.length = 1;
    if (kind == JointKind::distance) joint.frame_b.p += Vec3(1, 0, 0);
    const std::vector<JointRow> rows = locked_rows(joint, g);
    MatX J(Eigen::Index(rows.size()), 6);
    for (std::size_t i = 0; i < rows.size(); ++i) J.row(Eigen::Index(i)) = rows[i].J_a;
    EXPECT_EQ(Eigen::FullPivLU<MatX>(J).rank(), locked_count(kind)) << to_string(kind);
    if (kind != JointKind::spherical && kind != JointKind::distance) {
      EXPECT_EQ(locked_count(kind) + axis_count(kind), 6) << to_string(kind);
    }
  }
}

TEST(Joint, CoordinatesAreThoseOfAAsSeenFromB) {
  const PerBody<SE3> g{rotation(Vec3::UnitZ(), 0.3) * translation(0, 0, 0), SE3{}};
  Joint joint{.kind = JointKind::revolute, .body_a = 0, .body_b = 1};
  EXPECT_NEAR(axis_row(joint, g, 0).value, 0.3, 1e-15);
  joint.kind = JointKind::planar;
  const PerBody<SE3> shifted{translation(1, 2, 0) * rotation(Vec3::UnitZ(), -0.4), SE3{}};
  EXPECT_NEAR(axis_row(joint, shifted, 0).value, 1, 1e-15);
  EXPECT_NEAR(axis_row(joint, shifted, 1).value, 2, 1e-15);
  EXPECT_NEAR(axis_row(joint, shifted, 2).value, -0.4, 1e-15);
  joint.kind = JointKind::universal;
  const PerBody<SE3> bent{rotation(Vec3::UnitZ(), 2) * rotation(Vec3::UnitX(), -1), SE3{}};
  EXPECT_NEAR(locked_rows(joint, bent)[3].value, 0, 1e-15);
  EXPECT_NEAR(axis_row(joint, bent, 0).value, 2, 1e-15);
  EXPECT_NEAR(axis_row(joint, bent, 1).value, -1, 1e-15);
  joint.kind = JointKind::screw;
  joint.pitch = 0.2;  // three turns and a quarter
  const PerBody<SE3> screwed{translation(0, 0, 3.25 * 0.2) * rotation(Vec3::UnitZ(), kPi / 2), SE3{}};
  EXPECT_NEAR(locked_rows(joint, screwed)[2].value, 0, 1e-15);
}

TEST(Mechanism, CountsTurnsAndMeasuresDrift) {
  Model model;
  add(model, RigidBody{.name = "wheel", .mass = 1, .inertia = Mat3::Identity()});
  add(model, Joint{.name = "axle", .kind = JointKind::revolute, .body_a = 0});
  State state = rest_state(model);
  for (int i = 1; i <= 20; ++i) {  // one radian each: more than three turns
    const PerBody<SE3> next{rotation(Vec3::UnitZ(), i)};
    state.turns = counted_turns(model, state, next);
    state.g = next;
    EXPECT_NEAR(joint_coordinate(model, state, 0), i, 1e-14);
  }
  EXPECT_EQ(state.turns, (std::vector<int>{3, 0, 0}));
  twist(state, 0) << 0, 0, 0, 0, 0, 2.5;
  EXPECT_NEAR(joint_speed(model, state, 0), 2.5, 1e-14);
  state.g[0] = translation(3e-3, 0, 4e-4) * rotation(Vec3::UnitX(), 1e-3);
  EXPECT_NEAR(joint_error(model, state).translation, 3e-3, 1e-15);
  EXPECT_NEAR(joint_error(model, state).rotation, std::sin(1e-3), 1e-15);
}

Model hinged() {
  Model model;
  add(model, RigidBody{.name = "door", .mass = 1, .inertia = Mat3::Identity()});
  add(model, fixed_body("house", -1));
  add(model, fixed_body("garden", -1));
  return model;
}
std::string refusal(const Joint& joint) {
  Model model = hinged();
  std::string message = message_of([&] { add(model, joint); });
  EXPECT_EQ(model.joints.size(), message.empty() ? 1u : 0u);
  return message;
}
TEST(Joint, RefusesWhatIsNoJoint) {
  const Joint good{.name = "hinge", .kind = JointKind::revolute, .body_a = 0, .body_b = 1};
  EXPECT_EQ(refusal(good), "");
  const auto with = [&](auto&& change) {
    Joint joint = good;
    change(joint);
    return refusal(joint);
  };
  const std::string who = "joint 0 (hinge): ";
  expect_names(with([](Joint& j) { j.body_a = 3; }), who + "body_a = 3 must lie in [-1, 3)");
  expect_names(with([](Joint& j) { j.body_b = -2; }), who + "body_b = -2");
  expect_names(with([](Joint& j) { j.body_b = 0; }), who + "body_b = 0 must differ from body_a");
  expect_names(with([](Joint& j) { j.body_a = 2; }), who + "one of its bodies must be dynamic");
  expect_names(with([](Joint& j) { j.frame_a.p.x() = kInf; }), who + "frame_a");
  expect_names(with([](Joint& j) { j.axis[0].lower = 2, j.axis[0].upper = 1; }), who + "axis[0].lower = 2");
  expect_names(with([](Joint& j) { j.axis[0].friction = -1; }), who + "axis[0].friction = -1");
  expect_names(with([](Joint& j) { j.axis[0].stiffness = -1; }), who + "axis[0].stiffness = -1");
  expect_names(with([](Joint& j) { j.axis[0].damping = kInf; }), who + "axis[0].damping = inf");
  expect_names(with([](Joint& j) { j.axis[0].restitution = 1.5; }), who + "axis[0].restitution = 1.5");
  expect_names(with([](Joint& j) { j.axis[0].motor.kind = MotorKind::speed; }), who + "axis[0].motor.target");
  expect_names(with([](Joint& j) { j.axis[0].motor.limit = 0; }), who + "axis[0].motor.limit = 0");
  expect_names(with([](Joint& j) { j.axis[0].motor.limit = 2; }),
               who + "axis[0].motor.limit = 2 must be inf");
  expect_names(with([](Joint& j) { j.axis[0].motor.target = [](double) { return 1.0; }; }),
               who + "axis[0].motor.target is set");
  expect_names(with([](Joint& j) { j.pitch = 1; }), who + "pitch = 1 must be 0");
  expect_names(with([](Joint& j) { j.length = 1; }), who + "length = 1 must be 0");
  expect_names(with([](Joint& j) { j.kind = JointKind::screw; }), who + "pitch = 0");
  expect_names(with([](Joint& j) { j.kind = JointKind::distance; }), who + "length = 0");
}

TEST(Coupling, IsRefusedUnlessItsAxesExist) {
  Model model = hinged();
  add(model, Joint{.name = "hinge", .kind = JointKind::revolute, .body_a = 0, .body_b = 1});
  add(model, Joint{.name = "ball", .kind = JointKind::spherical, .body_a = 0, .body_b = 2});
  const auto refused = [&](Coupling c) { return message_of([&] { add(model, c); }); };
  expect_names(refused({.name = "gear", .joint_1 = 0, .joint_2 = 2}),
               "coupling 0 (gear): joint_2 = 2 must lie in [0, 2)");
  expect_names(refused({.joint_1 = 0, .joint_2 = 1}), "axis_2 = 0 must lie in [0, 0)");
  expect_names(refused({.joint_1 = 0, .joint_2 = 0}), "its two axes must differ");
  EXPECT_TRUE(model.couplings.empty());
}

TEST(Joint, LetsItsBodiesPassUnlessToldOtherwise) {
  Model model = hinged();
  add(model, Joint{.kind = JointKind::revolute, .body_a = 1, .body_b = 0});
  EXPECT_TRUE(model.passing.contains({0, 1}));
  EXPECT_FALSE(model.passing.contains({0, 2}));
}

TEST(Joint, MakesItsBodiesCollideIfToldSo) {
  Model model = hinged();
  add(model, Joint{.name = "slide", .kind = JointKind::prismatic, .body_a = 1, .body_b = 0, .collide = true});
  EXPECT_TRUE(model.passing.empty());
  add(model, Joint{.name = "stay",
                   .kind = JointKind::distance,
                   .body_a = 0,
                   .body_b = 1,
                   .collide = true,
                   .length = 1});
  const auto refused = [&](Joint joint) {
    joint.kind = JointKind::revolute;
    return message_of([&] { add(model, joint); });
  };
  expect_names(refused({.name = "pin", .body_a = 0, .body_b = 1}),
               "joint 2 (pin): without collide contradicts joint slide of the same bodies");
  EXPECT_TRUE(model.passing.empty());
  expect_names(refused({.name = "pin", .body_a = 0, .collide = true}),
               "joint 2 (pin): collide needs two bodies");
  EXPECT_EQ(refused({.name = "hinge", .body_a = 0, .body_b = 2}), "");
  expect_names(refused({.name = "pin", .body_a = 2, .body_b = 0, .collide = true}),
               "joint 3 (pin): collide contradicts Model::passing");
  EXPECT_EQ(message_of([&] { validate(model); }), "");
  model.passing.insert({0, 1});
  expect_names(message_of([&] { validate(model); }), "joint 0 (slide): collide contradicts Model::passing");
}

TEST(Model, RefusesBlocksAndGapsThatCannotBe) {
  Model model;
  EXPECT_NE(message_of([&] { validate(model); }).find("neither bodies nor coordinates"), std::string::npos);
  const auto mass = [](const VecX&) -> MatX { return MatX::Identity(1, 1); };
  expect_names(message_of([&] { add(model, Coordinates{.name = "x", .size = 0, .mass = mass}); }),
               "coordinates 0 (x): size = 0 must be at least 1");
  expect_names(message_of([&] { add(model, Coordinates{.name = "x", .size = 1}); }), "mass must be callable");
  EXPECT_EQ(add(model, Coordinates{.name = "x", .size = 1, .mass = mass}), BlockId(0));
  const auto wall = [](const Model&, const State&, double) { return GapRows{}; };
  expect_names(message_of([&] { add(model, GapFunction{.name = "wall", .block = 1, .evaluate = wall}); }),
               "gap function 0 (wall): block = 1 must lie in [-1, 1)");
  expect_names(message_of([&] { add(model, GapFunction{.name = "wall"}); }), "evaluate must be callable");
  expect_names(message_of([&] {
                 add(model, GapFunction{.name = "w", .evaluate = wall, .law = {.contensou_radius = 1}});
               }),
               "law.contensou_radius = 1 must be 0");
  EXPECT_EQ(message_of([&] { validate(model); }), "");
}

}  // namespace
}  // namespace aussois
