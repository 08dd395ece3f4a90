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
      const Vec3 difference =
          (block_answer<3>(coulomb(mu), x + e) - block_answer<3>(coulomb(mu), x - e)) / (2 * step);
      EXPECT_LT((D.col(j) - difference).norm(), 1e-8)
          << "seed 3, case " << i;  // step^2 / 0.1^3, and 1e-16 / step
    }
  }
  EXPECT_GT(std::min({open, stick, slip}), 50);
}

const Law kKinds[]{coulomb(0.4),      coulomb_2d(0.7), rolling(0.5, 0.2), rolling(0.3, 0),
                   contensou(0.6, 1), unilateral(),    bilateral(3),      dry_friction(0.8)};

// A point of the set: every ball filled by a random share.
AnyRows random_member(Random& random, const Law& law) {
  AnyRows y = uniform_vector(random, law.rows, -3, 3);
  if (has_normal(law)) y[0] = random.uniform(0, 3);
  for (const Ball& ball : balls(law)) {
    const double radius = ball.mu * y[0] * (ball.first > 0) + ball.limit;
    const double length = y.segment(ball.first, ball.rows).norm();
    y.segment(ball.first, ball.rows) *= radius * random.uniform(0, 1) / length;
  }
  return y;
}

TEST(Law, EveryKindProjectsOnTheNearestPoint) {
  for (const Law& law : kKinds) {
    Random random(4);
    for (int i = 0; i < 500; ++i) {
      const AnyRows x = uniform_vector(random, law.rows, -2, 2), p = project<Eigen::Dynamic>(law, x);
      EXPECT_LT((project<Eigen::Dynamic>(law, p) - p).norm(), 1e-15) << to_string(law.kind);
      for (int k = 0; k < 20; ++k)
        ASSERT_LE((x - p).dot(random_member(random, law) - p), 1e-13)
            << to_string(law.kind) << ", case " << i;
    }
  }
}

TEST(Law, EveryKindAnswersWithMaximalDissipation) {
  // r = block_answer(y) solves the block with unit compliance: u = r - y and the law (LAW-6).
  for (const Law& law : kKinds) {
    Random random(5);
    for (int i = 0; i < 500; ++i) {
      const AnyRows y = uniform_vector(random, law.rows, -2, 2), r = block_answer<Eigen::Dynamic>(law, y);
      const AnyRows u = r - y,
                    wrong = r - project<Eigen::Dynamic>(law, r - modified_velocity<Eigen::Dynamic>(law, u));
      EXPECT_LT(wrong.norm(), 1e-14) << to_string(law.kind) << ", case " << i;
    }
  }
}

TEST(Law, EveryDerivativeIsThatOfCentralDifferences) {
  const double step = 1e-6;
  for (const Law& law : kKinds) {
    Random random(6);
    int close = 0;
    for (int i = 0; i < 300; ++i) {
      const AnyRows y = uniform_vector(random, law.rows, -2, 2);
      const AnyBlock D = answer_derivative<Eigen::Dynamic>(law, y);
      double worst = 0;
      for (int j = 0; j < law.rows; ++j) {
        AnyRows e = AnyRows::Zero(law.rows);
        e[j] = step;
        const AnyRows difference =
            (block_answer<Eigen::Dynamic>(law, y + e) - block_answer<Eigen::Dynamic>(law, y - e)) /
            (2 * step);
        worst = std::max(worst, (D.col(j) - difference).norm());
      }
      close += worst < 1e-6;
    }
    EXPECT_GE(close, 295) << to_string(law.kind);  // the others lie at a kink or near the axis
  }
}

// -0.0 = 0 * (-5): an open frictionless contact is outside the ray, not on it.
TEST(Law, WithoutFrictionIsTheRayOfPositiveNormals) {
  EXPECT_EQ(project_cone({-5, 0, 0}, 0), Vec3(0, 0, 0));
  EXPECT_EQ(project_cone({5, 0, 0}, 0), Vec3(5, 0, 0));
  EXPECT_EQ(project_cone({5, 3, 4}, 0), Vec3(5, 0, 0));
}

}  // namespace
}  // namespace aussois
