// SPDX-License-Identifier: Apache-2.0
#include "geometry/se3.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"
#include "tests/unit/geometry/samples.hpp"

namespace aussois {
namespace {

constexpr unsigned kSeed = 20122;
// Of central differences: truncation and rounding both near 1e-10 for twists of size 4
constexpr double kStep = 1e-5;

// f(twist) for translations up to 2 m with the delicate angles, 10 each.
template <class F>
void for_each_twist(F f) {
  Random random(kSeed);
  for (const double angle : kAngles) {
    for (int i = 0; i < 10; ++i) {
      Vec6 twist;
      twist << random.vector(2), angle * random.direction();
      SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", angle " << angle << ", sample " << i);
      f(twist, random);
    }
  }
}

SE3 random_pose(Random& random) {
  return {exp_so3(random.vector(1.8)), random.vector(2)};
}

Vec6 random_twist(Random& random) {
  Vec6 twist;
  twist << random.vector(1), random.vector(1);
  return twist;
}

Eigen::Matrix4d matrix(const SE3& g) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Identity();
  A.topLeftCorner<3, 3>() = g.R.toRotationMatrix();
  A.topRightCorner<3, 1>() = g.p;
  return A;
}

Eigen::Matrix4d power_series(const Vec6& twist) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<3, 3>() = skew(twist.tail<3>());
  A.topRightCorner<3, 1>() = twist.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int k = 1; k <= 40; ++k) {
    term = term * A / k;
    sum += term;
  }
  return sum;
}

double distance(const SE3& a, const SE3& b) {
  return (matrix(a) - matrix(b)).norm();
}

TEST(SE3, ProductAndInverseAreThoseOfMatrices) {
  Random random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const SE3 a = random_pose(random), b = random_pose(random), c = random_pose(random);
    const Vec3 x = random.vector(1);
    EXPECT_LT((matrix(a * b) - matrix(a) * matrix(b)).norm(), 1e-14) << "seed " << kSeed;
    EXPECT_LT(distance((a * b) * c, a * (b * c)), 1e-14) << "seed " << kSeed;
    EXPECT_LT(distance(a * inverse(a), SE3{}), 1e-14) << "seed " << kSeed;
    EXPECT_LT(distance(a * SE3{}, a), 3e-15) << "seed " << kSeed;
    EXPECT_LT(((a * b) * x - a * (b * x)).norm(), 1e-14) << "seed " << kSeed;
  }
}

TEST(SE3, StaysAUnitQuaternionThroughManyProducts) {
  SE3 g;
  const SE3 step = exp_se3((Vec6() << 1e-3, 0, 0, 0.1, 0.2, 0.3).finished());
  for (int i = 0; i < 100000; ++i) g = g * step;
  EXPECT_NEAR(g.R.norm(), 1, 4e-16);
}

TEST(SE3, ExponentialIsThatOfTheMatrix) {
  for_each_twist([](const Vec6& twist, auto&) {
    EXPECT_LT((matrix(exp_se3(twist)) - power_series(twist)).norm(), 5e-14);
  });
}

// A quarter turn about the vertical axis through (1, 0, 0) takes the origin to (1, -1, 0).
TEST(SE3, ExponentialTurnsAboutAnAxisBesideTheOrigin) {
  const Vec3 omega(0, 0, kPi / 2), centre(1, 0, 0);
  Vec6 twist;
  twist << centre.cross(omega), omega;
  EXPECT_LT((exp_se3(twist) * Vec3(0, 0, 0) - Vec3(1, -1, 0)).norm(), 1e-15);
  EXPECT_LT((exp_se3(twist) * centre - centre).norm(), 1e-15);
}

TEST(SE3, LogarithmUndoesTheExponential) {
  for_each_twist(
      [](const Vec6& twist, auto&) { EXPECT_LT((log_se3(exp_se3(twist)) - twist).norm(), 1e-14); });
}

TEST(SE3, AdjointCarriesTwistsThroughAPose) {
  Random random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const SE3 g = random_pose(random);
    const Vec6 twist = random_twist(random);
    EXPECT_LT(distance(g * exp_se3(twist) * inverse(g), exp_se3(adjoint(g) * twist)), 3e-14)
        << "seed " << kSeed;
  }
}

TEST(SE3, DifferentialsAgreeWithCentralDifferences) {
  for_each_twist([](const Vec6& twist, auto& random) {
    const Vec6 direction = random_twist(random);
    const SE3 ahead = exp_se3(twist + kStep * direction), behind = exp_se3(twist - kStep * direction);
    const Vec6 left = log_se3(ahead * inverse(behind)) / (2 * kStep);
    const Vec6 right = log_se3(inverse(behind) * ahead) / (2 * kStep);
    EXPECT_LT((dexp_left_se3(twist) * direction - left).norm(), 1e-9);
    EXPECT_LT((dexp_right_se3(twist) * direction - right).norm(), 1e-9);
  });
}

TEST(SE3, LeftDifferentialIsTheAdjointTimesTheRight) {
  for_each_twist([](const Vec6& twist, auto&) {
    EXPECT_LT((dexp_left_se3(twist) - adjoint(exp_se3(twist)) * dexp_right_se3(twist)).norm(), 2e-14);
  });
}

TEST(SE3, DifferentialIsContinuousAcrossTheSwitchOfTheSeries) {
  Vec6 below, above;
  below << 0.3, -0.4, 1.2, Vec3(0.6, 0, 0.8) * (1 - 1e-15);
  above << 0.3, -0.4, 1.2, Vec3(0.6, 0, 0.8) * (1 + 1e-15);
  ASSERT_LT(below.tail<3>().squaredNorm(), 1);
  ASSERT_GE(above.tail<3>().squaredNorm(), 1);
  EXPECT_LT((dexp_left_se3(below) - dexp_left_se3(above)).norm(), 1e-14);
}

TEST(SE3, RotationTakesAnAxisOfAnyLength) {
  const SE3 g = rotation({0, 0, 1e-200}, kPi / 2);
  EXPECT_LT((g * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_THROW(rotation(Vec3::Zero(), 1), std::invalid_argument);
  EXPECT_THROW(rotation({0, 0, kInf}, 1), std::invalid_argument);
  EXPECT_THROW(rotation({0, 0, 1}, std::nan("")), std::invalid_argument);
}

TEST(SE3, TranslationMovesWithoutTurning) {
  EXPECT_EQ(translation(1, 2, 3) * Vec3(10, 20, 30), Vec3(11, 22, 33));
}

TEST(SE3, CheckedPoseNormalisesAndNamesWhatIsWrong) {
  const auto refusal = [](const SE3& g) { return message_of([&] { checked_pose(g, "pose 7"); }); };
  const SE3 almost{Quat(1 + 5e-7, 0, 0, 0), {1, 2, 3}};
  EXPECT_NEAR(checked_pose(almost, "pose").R.norm(), 1, 1e-16);
  EXPECT_EQ(checked_pose(almost, "pose").p, almost.p);
  EXPECT_EQ(refusal({Quat(1.25, 0, 0, 0), Vec3::Zero()}), "|pose 7.R| = 1.25 must be 1 within 1e-6");
  EXPECT_NE(refusal({Quat(std::nan(""), 0, 0, 0), Vec3::Zero()}), "");
  EXPECT_NE(refusal({Quat::Identity(), {0, kInf, 0}}).find("pose 7.p = 0 inf 0 must"), std::string::npos);
}

}  // namespace
}  // namespace aussois
