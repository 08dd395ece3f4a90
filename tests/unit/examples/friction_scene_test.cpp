// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/families/friction_scene.hpp"

#include <gtest/gtest.h>

#include "examples/common/random.hpp"
#include "nsgs/solve.hpp"

namespace aussois {
namespace {

const Law kLaw = coulomb(0.5);

SE3 at_height(double z) {
  return translation(0, 0, z);
}

}  // namespace

TEST(FrictionScene, WeighsABoxByItsFormulaInAnyPose) {
  Random random(3);
  const SE3 pose = random.pose(2);
  const Vec3 size(0.3, 0.2, 0.1);
  FrictionScene scene;
  const SceneBody& body = scene.bodies[add_box(scene, size, pose, 700)];
  const double mass = 700 * 0.3 * 0.2 * 0.1;
  const Vec3 square = size.cwiseProduct(size), inertia = mass / 12 * (Vec3::Constant(square.sum()) - square);
  const Mat3 R = pose.R.toRotationMatrix();
  EXPECT_NEAR(body.mass, mass, 1e-12 * mass);
  EXPECT_LT((body.centre - pose.p).norm(), 1e-14);
  EXPECT_LT((body.inertia - R * inertia.asDiagonal() * R.transpose()).norm(), 1e-12 * inertia.norm());
}

TEST(FrictionScene, WeighsAPrismOfManySidesAsADisk) {
  FrictionScene scene;
  std::vector<Vec2> circle;
  for (int i = 0; i < 2000; ++i)
    circle.push_back(0.4 * Vec2(std::cos(kPi * i / 1000), std::sin(kPi * i / 1000)));
  const int prism = add_prism(scene, circle, at_height(1), 0.1, 500);
  const int disk = add_disk(scene, 0.4, 0.1, Vec3(0, 0, 1), 500);
  const SceneBody &p = scene.bodies[prism], &d = scene.bodies[disk];
  EXPECT_NEAR(p.mass, d.mass, 1e-5 * d.mass);  // the polygon lacks 4e-6 of the circle
  EXPECT_LT((p.inertia - d.inertia).norm(), 1e-5 * d.inertia.norm());
}

TEST(FrictionScene, TouchesAtTheCornersOfTheSharedPolygon) {
  FrictionScene scene;
  const int low = add_box(scene, Vec3(2, 2, 2), at_height(-1), 0);
  const int high = add_box(scene, Vec3(2, 2, 2), translation(1.5, 0.5, 1), 1);
  touch_faces(scene, 1e-9, kLaw);
  ASSERT_EQ(scene.contacts.size(), 4u);  // [0.5, 1] x [-0.5, 1]
  Vec3 sum = Vec3::Zero();
  for (const Interaction& at : scene.contacts) {
    EXPECT_EQ(at.a, high);
    EXPECT_EQ(at.b, low);
    EXPECT_EQ(at.gap, 0);
    EXPECT_LT((at.rows[0].head<3>() - Vec3::UnitZ()).norm(), 1e-15);
    EXPECT_NEAR(std::abs(at.point.x() - 0.75), 0.25, 1e-14);
    EXPECT_NEAR(std::abs(at.point.y() - 0.25), 0.75, 1e-14);
    sum += at.point;
  }
  EXPECT_LT((sum / 4 - Vec3(0.75, 0.25, 0)).norm(), 1e-14);
}

TEST(FrictionScene, FindsTheOctagonOfTurnedSquares) {
  FrictionScene scene;
  add_box(scene, Vec3(2, 2, 2), at_height(-1), 0);
  add_box(scene, Vec3(2, 2, 2), at_height(1) * rotation(Vec3::UnitZ(), kPi / 4), 1);
  touch_faces(scene, 1e-9, kLaw);
  ASSERT_EQ(scene.contacts.size(), 8u);
  for (const Interaction& at : scene.contacts)
    EXPECT_NEAR(at.point.norm(), std::sqrt(4 - 2 * std::sqrt(2.0)), 1e-12);  // 1 / cos(pi / 8)
}

TEST(FrictionScene, LeavesOutWhatOnlyMeetsAtAnEdgeIsFarOrCannotMove) {
  FrictionScene scene;
  add_box(scene, Vec3(2, 2, 2), at_height(-1), 0);
  add_box(scene, Vec3(2, 2, 2), translation(2, 0, -1), 0);       // both fixed
  add_box(scene, Vec3(2, 2, 2), translation(-2, 0, 1), 1);       // an edge
  add_box(scene, Vec3(0.1, 0.1, 1), translation(0, 0, 1.5), 1);  // half a metre above
  touch_faces(scene, 0.1, kLaw);
  EXPECT_TRUE(scene.contacts.empty());
}

TEST(FrictionScene, LetsAGapCloseWithinTheStepAndNoFurther) {
  FrictionScene scene;
  add_box(scene, Vec3(1, 1, 1), at_height(-0.5), 0);
  add_box(scene, Vec3(1, 1, 1), at_height(0.5 + 1e-4), 1000);
  touch_faces(scene, 1e-3, kLaw);
  scene.h = 0.1;
  ASSERT_EQ(scene.contacts.size(), 4u);
  const FrictionSolution s = solve(friction_problem(scene), {}, {.tolerance = 1e-12});
  EXPECT_NEAR(s.v[2], -1e-4 / 0.1, 1e-9);
}

TEST(FrictionScene, RebouncesWithNewtonsCoefficient) {
  FrictionScene scene{.gravity = Vec3::Zero()};
  scene.bodies.emplace_back();
  const int ball = add_ball(scene, 0.1, Vec3(0, 0, 0.1), 1000);
  scene.bodies.back().twist[2] = -3;
  scene.contacts.push_back(contact(ball, 0, Vec3::Zero(), Vec3::UnitZ(), kLaw));
  scene.contacts.back().restitution = 0.4;
  const FrictionSolution s = solve(friction_problem(scene), {}, {.tolerance = 1e-12});
  EXPECT_NEAR(s.v[2], 0.4 * 3, 1e-10);
}

TEST(FrictionScene, RollsASpinningBallByTwoSeventhsOfItsSpin) {
  FrictionScene scene{.gravity = Vec3(0, 0, -10),
                      .h = 1};  // an impulse of the ground large enough to stop the slip
  scene.bodies.emplace_back();
  const int ball = add_ball(scene, 0.1, Vec3(0, 0, 0.1), 1000);
  scene.bodies.back().twist[4] = 7;
  scene.contacts.push_back(contact(ball, 0, Vec3::Zero(), Vec3::UnitZ(), kLaw));
  const FrictionSolution s = solve(friction_problem(scene), {}, {.tolerance = 1e-12});
  EXPECT_NEAR(s.v[4], 7 * 2 / 7.0, 1e-10);
  EXPECT_NEAR(s.v[0], 0.1 * 2, 1e-10);
}

TEST(FrictionScene, TurnsAFreeTopByEulersEquationsToFirstOrder) {
  for (const double theta : {0.0, 1.0}) {
    FrictionScene scene{.gravity = Vec3::Zero(), .h = 1e-6, .theta = theta};
    add_box(scene, Vec3(0.3, 0.2, 0.1), at_height(0), 1000);
    SceneBody& body = scene.bodies.back();
    const Vec3 omega(1, 2, 3);
    body.twist.tail<3>() = omega;
    const Vec3 expected = -body.inertia.inverse() * omega.cross(body.inertia * omega);
    const FrictionProblem problem = friction_problem(scene);
    const Vec3 after = MatX(problem.M).bottomRightCorner<3, 3>().partialPivLu().solve(problem.f.tail<3>());
    EXPECT_LT(((after - omega) / scene.h - expected).norm(), 1e-4 * expected.norm()) << theta;  // O(h)
  }
}

}  // namespace aussois
