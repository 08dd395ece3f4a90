// SPDX-License-Identifier: Apache-2.0
// What a run may begin with.
#include <gtest/gtest.h>

#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

std::string refusal(const Model& model, const State& state) {
  return message_of([&] { validate_start(model, state); });
}
void expect_names(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Start, IsRefusedInOverlapBeyondTheDilations) {
  Scene s = block_on_plate(0.3, 0, 0);
  EXPECT_EQ(refusal(s.model, s.state), "");
  for (const double depth : {0.5 * kRadius, 3 * kRadius, 0.4 * kSide}) {
    pose(s.state, s.block).p.z() = kSide / 2 + 2 * kRadius - depth;
    const double distance = std::max(0.0, 2 * kRadius - depth);  // of the bases
    const std::string message = refusal(s.model, s.state),
                      begin = "start: bodies 0 (ground) and 1 (block): base distance = ";
    ASSERT_EQ(message.find(begin), 0U) << message;
    EXPECT_NEAR(std::stod(message.substr(begin.size())), distance, 1e-15);
    expect_names(message, " must be at least 0.00192 [m]");
    State tried = s.state;  // and the scheme would not have taken it
    EXPECT_EQ(MoreauJean(s.model, {}).step(tried).status, StepStatus::refused);
  }
  s.model.passing.insert({s.ground, s.block});
  EXPECT_EQ(refusal(s.model, s.state), "");
  EXPECT_EQ(message_of([&] { validate_start(s.model, s.state, {.max_overlap = 2}); }).find("Advancement"),
            0U);
  EXPECT_EQ(message_of([&] { validate_start(s.model, s.state, {}, {.tolerance = 0}); }).find("JointOptions"),
            0U);
}

// Overlap of bodies that a joint lets pass is accepted; if they collide by the joint, the refusal names it.
TEST(Start, IsRefusedWithAJointWhoseCollidingBodiesOverlap) {
  const auto hinged = [](bool collide) {
    Scene s = block_on_plate(0.3, 0, 0, -0.5 * kRadius);
    Joint joint = joint_at(JointKind::planar, "table", s.block, s.ground, s.state.g, SE3{});
    joint.collide = collide;
    add(s.model, joint);
    return s;
  };
  const Scene passing = hinged(false), colliding = hinged(true);
  EXPECT_EQ(refusal(passing.model, passing.state), "");
  const std::string message = refusal(colliding.model, colliding.state);
  expect_names(message, "start: bodies 0 (ground) and 1 (block): base distance = ");
  expect_names(message, "[m]; they touch each other because joint 0 (table) has collide");
}

TEST(Start, IsRefusedWithAPieceOfABodyInsideAnother) {
  Scene s = block_on_plate(0.3, 0, 0, 0.1);
  const SimplicialComplex lump = make_box(0.01, 0.01, 0.01);
  const auto lumps = add(s.model, prepare(dilate(merged({lump, moved(lump, 1, 0, 0)}, true), kRadius)));
  const auto dumbbell =
      add(s.model, solid_body("dumbbell", lumps, mass_properties(make_box(1, 0.01, 0.01), kDensity)));
  s.state = rest_state(s.model);
  pose(s.state, s.block).p.z() = 1;
  pose(s.state, dumbbell).p = Vec3(-1, 0, 1);
  expect_names(refusal(s.model, s.state),
               "start: 1 of 2 pieces of body 2 (dumbbell) lie inside the solid of body 1 (block), one at (");
  pose(s.state, dumbbell).p.x() = -0.5;
  EXPECT_EQ(refusal(s.model, s.state), "");
  pose(s.state, dumbbell).p.x() = -0.05;  // crosses a face
  expect_names(refusal(s.model, s.state), "base distance = 0 ");
}

TEST(Start, IsRefusedWithAJointThatDoesNotHoldUntilItIsMadeConsistent) {
  Scene s = block_on_plate(0.3, 0, 0, 0.1);
  add(s.model, joint_at(JointKind::revolute, "hinge", s.block, kWorld, s.state.g, pose(s.state, s.block)));
  EXPECT_EQ(refusal(s.model, s.state), "");
  pose(s.state, s.block).p.x() += 1e-3;
  expect_names(refusal(s.model, s.state), "start: joint 0 (hinge): translation error [m] = 0.001");
  EXPECT_EQ(refusal(s.model, consistent_state(s.model, s.state)), "");
  pose(s.state, s.block).R = exp_so3(Vec3(0.01, 0, 0));
  pose(s.state, s.block).p.x() -= 1e-3;
  expect_names(refusal(s.model, s.state), "rotation error [rad] = ");
}

TEST(Start, IsRefusedWithMatricesOfTheWrongSizeAndSoIsEveryStep) {
  const auto with = [](const MatX& mass, const VecX& f, const MatX& K, const MatX& J) {
    Model model;
    add(model, Coordinates{.name = "x",
                           .size = 2,
                           .mass = [=](const VecX&) { return mass; },
                           .force =
                               [=](double, const VecX&, const VecX&) {
                                 return CoordinateForce{f, K, {}};
                               }});
    add(model, GapFunction{.name = "wall", .block = 0, .evaluate = [=](const Model&, const State&, double) {
                             return GapRows{.gap = 1, .J = J};
                           }});
    State state = rest_state(model);
    std::string message = refusal(model, state);
    State moved = state;
    for (const std::string& scheme : scheme_names()) {
      const std::string refused = message_of<std::invalid_argument>(
          [&] { EXPECT_TRUE(make_scheme(scheme, model, {}).step(moved, 1e-3).ok()) << scheme; });
      EXPECT_EQ(refused.empty(), message.empty()) << scheme;
      if (!refused.empty()) {
        EXPECT_EQ("start: " + refused, message) << scheme;
        EXPECT_EQ(hash(moved), hash(state)) << scheme;
      }
    }
    return message;
  };
  const MatX I = MatX::Identity(2, 2), none, J = MatX::Ones(1, 2);
  const VecX f = VecX::Zero(2);
  EXPECT_EQ(with(I, f, none, J), "");
  expect_names(with(MatX::Identity(3, 3), f, none, J), "coordinates 0 (x): mass = 3 x 3 must be 2 x 2");
  expect_names(with(I, VecX::Zero(1), none, J), "coordinates 0 (x): force.f = 1 x 1 must be 2 x 1");
  expect_names(with(I, f, MatX::Zero(1, 2), J), "force.K = 1 x 2 must be 2 x 2");
  expect_names(with(I, f, none, MatX::Ones(1, 3)), "gap function 0 (wall): J = 1 x 3 must be 1 x 2");
  expect_names(with(I, f, none, MatX::Ones(4, 2)), "rows of J = 4 must lie in [1, 3]");
}

TEST(Start, IsRefusedWithAMassThatIsNotPositiveDefinite) {
  Model model;
  MatX M = MatX::Identity(2, 2);
  add(model, Coordinates{.name = "x", .size = 2, .mass = [&](const VecX&) { return M; }});
  const State state = rest_state(model);
  EXPECT_EQ(refusal(model, state), "");
  M(0, 1) = 0.5;
  expect_names(refusal(model, state), "largest |mass - transpose| = 0.5");
  M(1, 0) = 0.5, M(1, 1) = 0.2;
  expect_names(refusal(model, state), "mass must be positive definite");
}

}  // namespace
}  // namespace aussois
