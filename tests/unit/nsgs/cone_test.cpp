// SPDX-License-Identifier: Apache-2.0
#include "nsgs/cone.hpp"

#include <gtest/gtest.h>

#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

Vec3 random_vector(Random& random) {
  return uniform_vector(random, 3, -1, 1);
}

bool in_cone(const Vec3& r, double mu) {
  return r.tail<2>().norm() <= mu * r[0] + 1e-15;
}

TEST(Cone, ProjectionIsTheNearestPoint) {
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

TEST(Cone, DecomposesEveryVectorIntoAConeAndItsPolar) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double mu = random.uniform(0, 2);
    const Vec3 x = random_vector(random), r = project_cone(x, mu), u = project_dual_cone(-x, mu);
    EXPECT_LE((x - (r - u)).norm(), 1e-15);  // Moreau
    EXPECT_NEAR(r.dot(u), 0, 1e-15);
    EXPECT_GE(u[0], mu * u.tail<2>().norm() - 1e-15);
  }
}

TEST(Cone, WithoutFrictionIsTheNormalHalfLine) {
  EXPECT_EQ(project_cone({2, 3, 4}, 0), Vec3(2, 0, 0));
  EXPECT_EQ(project_cone({-2, 3, 4}, 0), Vec3(0, 0, 0));
}

TEST(Cone, DiskShortensOnlyWhatIsOutside) {
  EXPECT_EQ(project_disk({3, 4}, 5), Vec2(3, 4));
  EXPECT_LT((project_disk({3, 4}, 1) - Vec2(0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(project_disk({3, 4}, 0), Vec2(0, 0));
}

TEST(Cone, DeSaxceLiftsTheNormalByTheSlip) {
  EXPECT_EQ(de_saxce({1, 3, 4}, 0.5), Vec3(3.5, 3, 4));
}

TEST(Cone, CoulombDerivativeIsThatOfCentralDifferences) {
  Random random(3);
  int open = 0, stick = 0, slip = 0;
  const double step = 1e-6;
  for (int i = 0; i < 1000; ++i) {
    const double mu = random.uniform(0.1, 1.5);
    const Vec3 x = random_vector(random);
    const double to_kink = std::min(std::abs(x[0]), std::abs(x.tail<2>().norm() - mu * x[0]));
    if (to_kink < 1e-2 || x.tail<2>().norm() < 1e-1) continue;
    ++(x[0] < 0 ? open : x.tail<2>().norm() < mu * x[0] ? stick : slip);
    const Mat3 D = project_coulomb_derivative(x, mu);
    for (int j = 0; j < 3; ++j) {
      const Vec3 e = step * Vec3::Unit(j);
      const Vec3 difference = (project_coulomb(x + e, mu) - project_coulomb(x - e, mu)) / (2 * step);
      EXPECT_LT((D.col(j) - difference).norm(), 1e-8)
          << "seed 3, case " << i;  // step^2 / 0.1^3, and 1e-16 / step
    }
  }
  EXPECT_GT(std::min({open, stick, slip}), 50);
}

// -0.0 = 0 * (-5): an open frictionless contact is outside the ray, not on it.
TEST(Cone, WithoutFrictionIsTheRayOfPositiveNormals) {
  EXPECT_EQ(project_cone({-5, 0, 0}, 0), Vec3(0, 0, 0));
  EXPECT_EQ(project_cone({5, 0, 0}, 0), Vec3(5, 0, 0));
  EXPECT_EQ(project_cone({5, 3, 4}, 0), Vec3(5, 0, 0));
}

}  // namespace
}  // namespace aussois
