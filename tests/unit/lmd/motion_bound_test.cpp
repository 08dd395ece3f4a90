// SPDX-License-Identifier: Apache-2.0
#include "lmd/motion_bound.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

// A motion that turns by `angle` in dt.
RigidMotion random_motion(Random& random, double angle, double dt) {
  return {random.pose(1), random.vector(2), angle / dt * random.direction()};
}

// Largest displacement of the surface points of the ball that the bound is about, over the whole step.
double sampled_displacement(const RigidMotion& a, double radius, const RigidMotion& seen_from, double dt,
                            Random& random) {
  double moved = 0;
  const auto seen = [&](const Vec3& x, double s) {
    return Vec3(inverse(pose_at(seen_from, s)) * (pose_at(a, s) * x));
  };
  for (int point = 0; point < 40; ++point) {
    const Vec3 x = radius * random.direction();
    for (int i = 1; i <= 20; ++i) moved = std::max(moved, (seen(x, dt * i / 20) - seen(x, 0)).norm());
  }
  return moved;
}

// Question 10 of doc/theory/lmd.md: random screws, turns from nothing to several, many next to pi.
class MotionBounds : public ::testing::TestWithParam<double> {};

TEST_P(MotionBounds, AreNotExceededAtAnyTimeAndTheRelativeOneIsNotAboveTheSum) {
  Random random(21);
  const RigidMotion still{};
  double tightest = 0, tightest_pair = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const double dt = random.log_uniform(1e-4, 1), radius_a = random.uniform(0.01, 1),
                 radius_b = random.uniform(0, 1);
    const RigidMotion a = random_motion(random, GetParam() * random.uniform(0.999, 1.001), dt),
                      b = random_motion(random, GetParam() * random.uniform(), dt);
    const double alone = displacement_bound(a, radius_a, dt),
                 both = relative_displacement_bound(a, radius_a, b, radius_b, dt);
    const double moved = sampled_displacement(a, radius_a, still, dt, random);
    EXPECT_LE(moved, alone + 1e-12) << sample;
    EXPECT_LE(both, alone + displacement_bound(b, radius_b, dt) + 1e-12) << sample;
    tightest = std::max(tightest, moved / alone);
    // Two body points cannot approach by more than the relative bound.
    double approached = 0;
    for (int probe = 0; probe < 200; ++probe) {
      const Vec3 x = radius_a * random.direction(), y = radius_b * random.direction();
      const double s = random.uniform(0, dt);
      approached =
          std::max(approached, (a.g * x - b.g * y).norm() - (pose_at(a, s) * x - pose_at(b, s) * y).norm());
    }
    EXPECT_LE(approached, both + 1e-12) << sample;
    tightest_pair = std::max(tightest_pair, approached / both);
  }
  EXPECT_GT(tightest, 0.8);  // the sample comes near what it tests
  EXPECT_GT(tightest_pair, 0.4);
}

INSTANTIATE_TEST_SUITE_P(Turns, MotionBounds, ::testing::Values(0.0, 1e-6, 0.1, 1.0, 3.1, kPi, 3.2, 10.0));

// Two bodies on one carousel do not move relative to each other: the bound is of second order in the step.
TEST(MotionBound, OfBodiesThatMoveAsOneIsOfSecondOrder) {
  const Vec3 omega(0, 0, 1);
  const RigidMotion a{translation(2, 0, 0), omega.cross(Vec3(2, 0, 0)), omega},
      b{translation(0, 3, 0), omega.cross(Vec3(0, 3, 0)), omega};
  for (const double dt : {1e-2, 1e-3}) {
    const double bound = relative_displacement_bound(a, 1, b, 1, dt);
    EXPECT_LT(bound, 2 * dt * dt);
    EXPECT_GT(displacement_bound(a, 1, dt) + displacement_bound(b, 1, dt), 5 * dt);
  }
}

// Any point of the ball, any direction of the cap, any time: seen from B the point does not move farther.
TEST(ApproachBound, HoldsForAllPointsOfABallAndAllDirectionsOfACap) {
  Random random(22);
  double tightest = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const double dt = random.log_uniform(1e-4, 0.5), radius_a = random.uniform(0.1, 1);
    const RigidMotion a{random.pose(1), random.vector(2), random.vector(3)},
        b{random.pose(1), random.vector(2), random.vector(sample % 2 ? 3 : 0)};
    const Approach approach = approach_of(a, b, dt);
    const double radius = random.uniform(0, 0.3) * radius_a,
                 half_angle = random.uniform(0, sample % 3 ? 0.3 : kPi);
    const Vec3 centre = a.g * random.vector_of_length(0, radius_a - radius), axis = random.direction();
    const double bound = approach_bound(approach, centre, radius, axis, half_angle);
    for (int probe = 0; probe < 60; ++probe) {
      const double from_centre = radius * (probe % 2 ? 1 : random.uniform());
      const Vec3 x = centre + from_centre * random.direction();
      const Vec3 side = axis.cross(random.direction()).normalized();
      const Vec3 u = exp_so3((probe % 3 ? 1 : random.uniform()) * half_angle * side) * axis;
      const double s = probe % 4 ? dt : random.uniform(0, dt);
      const auto seen_from_b = [&](double t) {
        return Vec3(inverse(pose_at(b, t)) * (pose_at(a, t) * (inverse(a.g) * x)));
      };
      const double moved = (b.g.R.conjugate() * u).dot(seen_from_b(s) - seen_from_b(0));
      ASSERT_LE(moved, bound + 1e-12) << sample;
      if (bound > 0) tightest = std::max(tightest, moved / bound);
    }
  }
  EXPECT_GT(tightest, 0.9);
}

// A nut that is screwed: every point of a flank moves along the flank, so contacts at a flank do not
// approach, while the isotropic bound is the whole displacement.
TEST(ApproachBound, OfAScrewMotionAlongItsThreadIsOfSecondOrder) {
  const double pitch = 2e-3, turns = 5;  // [m] per turn, [turns/s]
  const RigidMotion nut{{}, Vec3(0, 0, pitch * turns), Vec3(0, 0, 2 * kPi * turns)}, bolt{};
  const Vec3 flank(6e-3, 0,
                   0);  // the flank's normal is across the helix direction and, roughly, along the axis
  const Vec3 along = nut.v + nut.omega.cross(flank), normal = along.cross(Vec3::UnitX()).normalized();
  for (const double dt : {1e-3, 1e-4}) {
    const Approach approach = approach_of(nut, bolt, dt);
    const double bend = dt * dt / 2 * nut.omega.squaredNorm() * flank.norm();
    for (const Vec3& u : {normal, Vec3(-normal)})
      EXPECT_NEAR(approach_bound(approach, flank, 0, u, 0), bend, 1e-15);
    EXPECT_LT(bend, 0.02 * relative_displacement_bound(nut, 6e-3, bolt, 6e-3, dt));
  }
}

}  // namespace
}  // namespace aussois
