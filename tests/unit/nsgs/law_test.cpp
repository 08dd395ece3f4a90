// SPDX-License-Identifier: Apache-2.0
#include "nsgs/law.hpp"

#include <gtest/gtest.h>

#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

Vec3 random_vector(Random& random) {
  return uniform_vector(random, 3, -1, 1);
}

Vec3 project_cone(const Vec3& r, double mu) {
  return project<3>(coulomb(mu), r);
}

bool in_cone(const Vec3& r, double mu) {
  return r.tail<2>().norm() <= mu * r[0] + 1e-15;
}

TEST(Law, ProjectionIsTheNearestPoint) {
  Random random(1);
  int outside = 0;
  for (int i = 0; i < 1000; ++i) {
    const double mu = random.uniform(0, 2);
    const Vec3 x = random_vector(random), p = project_cone(x, mu);
    ASSERT_TRUE(in_cone(p, mu));
    outside += p != x;
    for (int k = 0; k < 50; ++k) {  // obtuse angle to every point of the cone: the projection and no other
      const double normal = random.uniform(0, 3), angle = random.uniform(-kPi, kPi);
      const double t = mu * normal * random.uniform(0, 1);
      const Vec3 y(normal, t * std::cos(angle), t * std::sin(angle));
      ASSERT_LE((x - p).dot(y - p), 1e-13) << "seed 1, case " << i;
    }
  }
  EXPECT_GT(outside, 300);
  EXPECT_LT(outside, 1000);
}

TEST(Law, DecomposesEveryVectorIntoAConeAndItsPolar) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double mu = random.uniform(0, 2);
    const Vec3 x = random_vector(random), r = project_cone(x, mu), u = r - x;  // Moreau
    EXPECT_NEAR(r.dot(u), 0, 1e-15);
    EXPECT_GE(u[0], mu * u.tail<2>().norm() - 1e-15);
  }
}

TEST(Law, WithoutFrictionIsTheNormalHalfLine) {
  EXPECT_EQ(project_cone({2, 3, 4}, 0), Vec3(2, 0, 0));
  EXPECT_EQ(project_cone({-2, 3, 4}, 0), Vec3(0, 0, 0));
}

TEST(Law, DeSaxceLiftsTheNormalByTheSlip) {
  EXPECT_EQ(modified_velocity<3>(coulomb(0.5), {1, 3, 4}), Vec3(3.5, 3, 4));
}

TEST(Law, CoulombDerivativeIsThatOfCentralDifferences) {
  Random random(3);
  int open = 0, stick = 0, slip = 0;
  const double step = 1e-6;
  for (int i = 0; i < 1000; ++i) {
    const double mu = random.uniform(0.1, 1.5);
    const Vec3 x = random_vector(random);
    const double to_kink = std::min(std::abs(x[0]), std::abs(x.tail<2>().norm() - mu * x[0]));
    if (to_kink < 1e-2 || x.tail<2>().norm() < 1e-1) continue;
    ++(x[0] < 0 ? open : x.tail<2>().norm() < mu * x[0] ? stick : slip);
    const Mat3 D = answer_derivative<3>(coulomb(mu), x);
    for (int j = 0; j < 3; ++j) {
      const Vec3 e = step * Vec3::Unit(j);
      const Vec3 difference = (answer<3>(coulomb(mu), x + e) - answer<3>(coulomb(mu), x - e)) / (2 * step);
      EXPECT_LT((D.col(j) - difference).norm(), 1e-8)
          << "seed 3, case " << i;  // step^2 / 0.1^3, and 1e-16 / step
    }
  }
  EXPECT_GT(std::min({open, stick, slip}), 50);
}

// -0.0 = 0 * (-5): an open frictionless contact is outside the ray, not on it.
TEST(Law, WithoutFrictionIsTheRayOfPositiveNormals) {
  EXPECT_EQ(project_cone({-5, 0, 0}, 0), Vec3(0, 0, 0));
  EXPECT_EQ(project_cone({5, 0, 0}, 0), Vec3(5, 0, 0));
  EXPECT_EQ(project_cone({5, 3, 4}, 0), Vec3(5, 0, 0));
}

}  // namespace
}  // namespace aussois
