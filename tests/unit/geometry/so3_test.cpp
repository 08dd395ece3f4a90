// SPDX-License-Identifier: Apache-2.0
#include "geometry/so3.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/geometry/samples.hpp"

namespace aussois {
namespace {

constexpr unsigned kRotationSeed = 20121;
// Of central differences: truncation step^2 / 6, rounding 1e-16 / step: both near 1e-11
constexpr double kTurn = 1e-5;

// f(phi) for the delicate angles about 20 random axes each.
template <class F>
void for_each_rotation_vector(F f) {
  Random random(kRotationSeed);
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 phi = angle * random.direction();
      SCOPED_TRACE(::testing::Message()
                   << "seed " << kRotationSeed << ", angle " << angle << ", sample " << i);
      f(phi, random);
    }
  }
}

// exp of a matrix by its power series: 40 terms leave pi^40 / 40! = 1e-28.
Mat3 power_series(const Mat3& A) {
  Mat3 sum = Mat3::Identity(), term = Mat3::Identity();
  for (int k = 1; k <= 40; ++k) {
    term = term * A / k;
    sum += term;
  }
  return sum;
}

long double stumpff_in_long_double(int m, double x) {
  long double term = 1, sum = 0;
  for (int k = 1; k <= m; ++k) term /= k;
  for (int k = 0; k < 60; ++k) {
    sum += term;
    term *= -static_cast<long double>(x) / ((2 * k + m + 1) * (2 * k + m + 2));
  }
  return sum;
}

TEST(Stumpff, AgreesWithItsSeriesInLongDouble) {
  const double factorial[] = {1, 1, 2, 6, 24, 120};
  for (int m = 0; m <= 5; ++m) {
    for (double x = 0; x < 40; x += 0.0625 + x / 64) {  // up to an angle of 2 pi
      EXPECT_NEAR(stumpff(m, x), double(stumpff_in_long_double(m, x)), 1e-13 / factorial[m]) << m << " " << x;
    }
  }
}

TEST(Stumpff, IsContinuousWhereTheSeriesHandsOver) {
  const double factorial[] = {1, 1, 2, 6, 24, 120};
  for (int m = 0; m <= 5; ++m) {
    EXPECT_NEAR(stumpff(m, std::nextafter(1.0, 0.0)), stumpff(m, 1.0), 1e-13 / factorial[m]) << m;
  }
}

TEST(SO3, SkewIsTheCrossProduct) {
  EXPECT_EQ(skew({1, 2, 3}) * Vec3(4, 5, 6), Vec3(1, 2, 3).cross(Vec3(4, 5, 6)));
}

TEST(SO3, ExponentialIsThatOfTheSkewMatrix) {
  for_each_rotation_vector([](const Vec3& phi, auto&) {
    const Quat R = exp_so3(phi);
    EXPECT_NEAR(R.norm(), 1, 1e-15);
    EXPECT_LT((R.toRotationMatrix() - power_series(skew(phi))).norm(),
              2e-14);  // terms up to pi^3/3! = 5 cancel
  });
}

TEST(SO3, RotationsAboutOneAxisAdd) {
  for_each_rotation_vector([](const Vec3& phi, auto& random) {
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
    const Quat ab = exp_so3(a * phi) * exp_so3(b * phi);
    EXPECT_LT((ab.coeffs() - exp_so3((a + b) * phi).coeffs()).norm(), 1e-15);
  });
}

TEST(SO3, LogarithmUndoesTheExponential) {
  for_each_rotation_vector(
      [](const Vec3& phi, auto&) { EXPECT_LE((log_so3(exp_so3(phi)) - phi).norm(), 1e-15 * phi.norm()); });
}

TEST(SO3, ExponentialUndoesTheLogarithmOfAnyQuaternion) {
  Random random(kRotationSeed);
  int beyond_half_a_turn = 0;
  for (int i = 0; i < 200; ++i) {
    Quat R{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    R.normalize();
    beyond_half_a_turn += R.w() < 0;
    const Vec3 phi = log_so3(R);
    EXPECT_LE(phi.norm(), kPi * (1 + 1e-15)) << "seed " << kRotationSeed;
    EXPECT_LT((exp_so3(phi).toRotationMatrix() - R.toRotationMatrix()).norm(), 3e-15)
        << "seed " << kRotationSeed;
  }
  EXPECT_GT(beyond_half_a_turn, 50);  // both signs of the double cover were seen
  EXPECT_LT(beyond_half_a_turn, 150);
}

TEST(SO3, LogarithmIgnoresSignAndLengthOfTheQuaternion) {
  for_each_rotation_vector([](const Vec3& phi, auto&) {
    const Quat R = exp_so3(phi);
    EXPECT_EQ(log_so3(Quat(Eigen::Vector4d(-R.coeffs()))), log_so3(R));
    EXPECT_LT((log_so3(Quat(Eigen::Vector4d(3 * R.coeffs()))) - log_so3(R)).norm(),
              1e-15 * (phi.norm() + 1e-290));
  });
}

TEST(SO3, LogarithmOfHalfATurnHasItsFirstNonzeroEntryPositive) {
  EXPECT_EQ(log_so3(Quat(0, -1, 0, 0)), Vec3(kPi, 0, 0));
  EXPECT_EQ(log_so3(Quat(0, 0, -1, 0)), Vec3(0, kPi, 0));
  EXPECT_EQ(log_so3(Quat(-0.0, 0, 0, -1)), Vec3(0, 0, kPi));
  EXPECT_LT((log_so3(Quat(0, -0.6, 0.8, 0)) - kPi * Vec3(0.6, -0.8, 0)).norm(), 1e-15);
}

TEST(SO3, DifferentialsAgreeWithCentralDifferences) {
  for_each_rotation_vector([](const Vec3& phi, auto& random) {
    const Vec3 direction = random.direction();
    const Quat ahead = exp_so3(phi + kTurn * direction), behind = exp_so3(phi - kTurn * direction);
    EXPECT_LT((dexp_left(phi) * direction - log_so3(ahead * behind.conjugate()) / (2 * kTurn)).norm(), 1e-10);
    EXPECT_LT((dexp_right(phi) * direction - log_so3(behind.conjugate() * ahead) / (2 * kTurn)).norm(),
              1e-10);
  });
}

TEST(SO3, LeftDifferentialIsTheRotationTimesTheRight) {
  for_each_rotation_vector([](const Vec3& phi, auto&) {
    const Mat3 R = exp_so3(phi).toRotationMatrix();
    EXPECT_LT((dexp_left(phi) - R * dexp_right(phi)).norm(), 3e-15);
    EXPECT_LT((dexp_left(phi) - dexp_right(phi).transpose()).norm(), 3e-15);
  });
}

TEST(SO3, InverseDifferentialsAreInverses) {
  for_each_rotation_vector([](const Vec3& phi, auto&) {
    for (const double stretch : {1.0, 1.9}) {  // up to 0.95 full turns, where the condition number is near 20
      const Vec3 x = stretch * phi;
      EXPECT_LT((dexp_left_inverse(x) * dexp_left(x) - Mat3::Identity()).norm(), 1e-13);
      EXPECT_LT((dexp_right(x) * dexp_right_inverse(x) - Mat3::Identity()).norm(), 1e-13);
    }
  });
}

TEST(SO3, AngleBetweenSeesTheSmallestAngles) {
  for_each_rotation_vector([](const Vec3& phi, auto& random) {
    const Quat a = exp_so3(random.vector(3));
    const double rounding = 1e-15;  // of the unit quaternions
    EXPECT_NEAR(angle_between(a, a * exp_so3(phi)), phi.norm(), rounding);
    EXPECT_NEAR(angle_between(a, Quat(Eigen::Vector4d(-(a * exp_so3(phi)).coeffs()))), phi.norm(), rounding);
  });
}

}  // namespace
}  // namespace aussois
