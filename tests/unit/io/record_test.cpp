// SPDX-License-Identifier: Apache-2.0
#include "io/record.hpp"

#include <stdexcept>

#include "geometry/primitives.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

/// A fixed plate and two balls that share a shape, one above the other.
Model two_balls_on_a_plate() {
  Model model;
  const auto plate = add(model, prepare(dilate(make_box(1, 1, 0.1), 1e-3)));
  const auto ball = add(model, prepare(dilate(make_complex({Vec3::Zero()}, {}), 0.05)));
  add(model, fixed_body("plate", plate));
  for (const char* name : {"low", "high"}) {
    RigidBody body;
    body.name = name;
    body.shape = ball;
    body.mass = 2;
    body.inertia = Mat3::Identity() * 0.002;
    add(model, body);
  }
  return model;
}

}  // namespace

TEST(Record, TakesBodiesAndSharedShapesFromTheModel) {
  const RunHeader header = run_header(two_balls_on_a_plate());
  ASSERT_EQ(header.bodies.size(), 3u);
  EXPECT_EQ(header.meshes.size(), 2u) << "the balls share one mesh";
  EXPECT_EQ(header.bodies[2].name, "high");
  EXPECT_EQ(header.bodies[2].mesh, "low");
  EXPECT_EQ(header.bodies[2].dilation, 0.05);
  EXPECT_EQ(header.bodies[2].mass, 2);
  EXPECT_TRUE(header.bodies[0].fixed);
  EXPECT_FALSE(header.bodies[1].fixed);
  EXPECT_EQ(header.meshes.at("plate").faces.size(), 12u);
  EXPECT_TRUE(header.meshes.at("plate").wires.empty()) << "edges of triangles are no wires";
  EXPECT_EQ(header.meshes.at("low").vertices.size(), 1u);
}

TEST(Record, KeepsWiresAndRefusesTwoShapesOfOneName) {
  Model model;
  const auto wire = add(
      model, prepare(dilate(make_complex({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}}, {}, {{0, 1}, {1, 2}}), 0.01)));
  add(model, fixed_body("cable", wire));
  EXPECT_EQ(run_header(model).meshes.at("cable").wires.size(), 2u);
  const auto other = add(model, prepare(dilate(make_complex({Vec3::Zero()}, {}), 0.01)));
  add(model, fixed_body("cable", other));
  EXPECT_THROW(run_header(model), std::invalid_argument);
}

// A hinge about the vertical, once around and 0.3 rad more, off by a millimetre, and a coordinate beside it.
TEST(Record, TakesJointsCoordinatesAndMatchesIntoARow) {
  Model model;
  add(model, RigidBody{.name = "arm", .mass = 1, .inertia = Mat3::Identity()});
  State state = rest_state(model);
  add(model, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g, SE3{}));
  add(model, Coordinates{.name = "weight", .size = 2, .mass = [](const VecX&) -> MatX {
                           return MatX::Identity(2, 2);
                         }});
  state = rest_state(model);
  state.g[0] = translation(0, 0, 1e-3) * rotation(Vec3::UnitZ(), 0.3);
  state.turns = {1, 0, 0};
  state.q << 0.5, -0.25;
  state.v << 0, 0, 0, 0, 0, 4, 7, 8;
  StepReport report;
  report.joints = {{.force = {1, 2, 3},
                    .torque = {4, 5, 6},
                    .effort = {7, 0, 0},
                    .work = {.locked = 1,
                             .couplings = 2,
                             .stops = 3,
                             .friction = 4,
                             .motors = 5,
                             .springs = 6,
                             .supports = 7}}};
  report.t_joints = 0.25;
  report.matches = {.by_key = 5, .by_adjacency = 4, .by_geometry = 3, .unmatched = 2, .inherited = 1};

  const RunHeader header = run_header(model);
  ASSERT_EQ(header.joints.size(), 1u);
  EXPECT_EQ(header.joints[0].name, "hinge");
  EXPECT_EQ(header.joints[0].kind, "revolute");
  EXPECT_EQ(header.joints[0].pair, (std::array<int, 2>{0, -1}));
  ASSERT_EQ(header.blocks.size(), 1u);
  EXPECT_EQ(header.blocks[0].name, "weight");
  EXPECT_EQ(header.blocks[0].size, 2);

  const RunStep row = run_step(1, model, state, report);
  validate(header, row);
  EXPECT_EQ(row.velocity.size(), 6);
  EXPECT_EQ(row.q, Vec2(0.5, -0.25));
  EXPECT_EQ(row.q_speed, Vec2(7, 8));
  const RunJoint& hinge = row.joints.at(0);
  EXPECT_NEAR(hinge.coordinate.x(), 2 * kPi + 0.3, 1e-14);
  EXPECT_EQ(hinge.coordinate.tail<2>(), Vec2::Zero());
  EXPECT_NEAR(hinge.speed.x(), 4, 1e-14);
  EXPECT_NEAR(hinge.translation_error, 1e-3, 1e-15);
  EXPECT_NEAR(hinge.rotation_error, 0, 1e-15);
  EXPECT_EQ(hinge.force, Vec3(1, 2, 3));
  EXPECT_EQ(hinge.torque, Vec3(4, 5, 6));
  EXPECT_EQ(hinge.effort, Vec3(7, 0, 0));
  EXPECT_EQ(hinge.work_locked, 1);
  EXPECT_EQ(hinge.work_couplings, 2);
  EXPECT_EQ(hinge.work_stops, 3);
  EXPECT_EQ(hinge.work_friction, 4);
  EXPECT_EQ(hinge.work_motors, 5);
  EXPECT_EQ(hinge.work_springs, 6);
  EXPECT_EQ(hinge.work_supports, 7);
  EXPECT_EQ(row.joint_time, 0.25);
  EXPECT_EQ(row.contacts_matched, 12);
  EXPECT_EQ(row.matched_by_key, 5);
  EXPECT_EQ(row.matched_by_adjacency, 4);
  EXPECT_EQ(row.matched_by_geometry, 3);
  EXPECT_EQ(row.unmatched, 2);
  EXPECT_EQ(row.inherited, 1);

  const RunStep start = run_step(0, model, state);
  EXPECT_EQ(start.joints.at(0).coordinate, hinge.coordinate);
  EXPECT_EQ(start.joints.at(0).force, Vec3::Zero());
}

TEST(Record, PutsAStepIntoARow) {
  const Model model = two_balls_on_a_plate();
  State state = rest_state(model);
  state.t = 0.5;
  state.g[2].p = Vec3(0, 0, 1);
  state.v[6 + 2] = -3;  // the low ball falls at 3 m/s
  StepReport report;
  report.status = StepStatus::refused;
  report.h = 1e-3;
  report.min_gap = -1e-6;
  report.contacts_found = 9;
  report.solve.status = SolveStatus::max_iterations;
  report.solve.iterations = 77;
  report.solve.residual = 1e-5;
  report.energy.kinetic_change = 1;
  report.energy.contact_work = -0.25;
  report.impulse_gain = 0.5;
  StepContact contact;
  contact.point.a = {1, 0, 0, 4, {}};
  contact.point.b = {0, 2, 7, 3, {}};
  contact.point.x_a = Vec3(1, 2, 3);
  contact.point.x_b = Vec3(1, 2, 4);
  contact.point.gap = -1;
  contact.impulse = Vec3(0, 0, 5);
  report.contacts = {contact};

  const RunStep row = run_step(42, model, state, report, {Vec3(1, 0, 0), Vec3(0, 2, 0), false});
  validate(run_header(model), row);
  EXPECT_EQ(row.step, 42);
  EXPECT_EQ(row.time, 0.5);
  EXPECT_EQ(row.h, 1e-3);
  EXPECT_EQ(row.status, 1);
  EXPECT_EQ(row.solver_status, 2);
  report.solve.status = SolveStatus::at_rounding;  // numbers of old files stay what they are
  EXPECT_EQ(run_step(42, model, state, report).solver_status, 4);
  EXPECT_EQ(row.iterations, 77);
  EXPECT_EQ(row.contacts_found, 9);
  EXPECT_NEAR(row.kinetic, 0.5 * 2 * 9, 1e-14);
  EXPECT_NEAR(row.gravity, 2 * 9.81 * 1, 1e-12);  // the high ball, one metre above the origin
  EXPECT_EQ(row.energy_residual, 1.25);
  EXPECT_EQ(row.impulse_gain, 0.5);
  EXPECT_EQ(row.coupling_force, Vec3(1, 0, 0));
  EXPECT_EQ(row.coupling_torque, Vec3(0, 2, 0));
  ASSERT_EQ(row.contacts.size(), 1u);
  EXPECT_EQ(row.contacts[0].pair, (std::array<int, 2>{1, 0}));
  EXPECT_EQ(row.contacts[0].feature, (std::array<std::array<int, 3>, 2>{{{0, 0, 4}, {2, 7, 3}}}));
  EXPECT_EQ(row.contacts[0].point_b, Vec3(1, 2, 4));
  EXPECT_EQ(row.contacts[0].impulse, Vec3(0, 0, 5));
}

}  // namespace aussois
