// SPDX-License-Identifier: Apache-2.0
// The point of a hull nearest to the origin, by what makes it that: it lies in the hull, and no point of the
// hull lies nearer.
#include "geometry/min_norm_point.hpp"

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

void expect_nearest(const std::vector<Vec3>& g) {
  const MinNorm nearest = min_norm_point(g);
  double size = 0;
  for (const Vec3& x : g) size = std::max(size, x.norm());
  for (const Vec3& x : g) EXPECT_GE(nearest.point.dot(x), nearest.point.squaredNorm() - 1e-12 * size * size);
  std::vector<Vec3> seen_from_it;
  for (const int i : nearest.support) {
    seen_from_it.push_back(g[std::size_t(i)] - nearest.point);
    EXPECT_NEAR(nearest.point.dot(g[std::size_t(i)]), nearest.point.squaredNorm(), 1e-12 * size * size);
  }
  EXPECT_LE(nearest.support.size(), 4U);
  EXPECT_LT(min_norm_point(seen_from_it).point.norm(), 1e-7 * size) << "it lies in the hull of its support";
}

class MinNormPoint : public ::testing::TestWithParam<unsigned> {};

// Anywhere; on a ball; on a circle, which is flat; nearly in a plane; each with copies.
TEST_P(MinNormPoint, IsInTheHullAndNothingIsNearer) {
  Random random(GetParam());
  const Vec3 shift = random.vector_of_length(0, 2);
  std::vector<Vec3> any, ball, circle, flat;
  for (int i = 1 + random.index(12); i > 0; --i) {
    any.push_back(shift + random.vector());
    ball.push_back(random.direction());
    const double angle = random.uniform(0, 4);
    circle.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    flat.push_back(Vec3(std::cos(angle), std::sin(angle), 1e-6 * random.uniform()).normalized());
  }
  for (std::vector<Vec3> g : {any, ball, circle, flat}) {
    expect_nearest(g);
    g.push_back(g[0]);
    expect_nearest(g);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, MinNormPoint, ::testing::Range(0U, 200U));

TEST(MinNormPointOf, CornersOfABoxIsOnItsNearestFace) {
  std::vector<Vec3> corners;
  for (const double x : {1.0, 3.0})
    for (const double y : {-1.0, 2.0})
      for (const double z : {-2.0, 1.0}) corners.emplace_back(x, y, z);
  EXPECT_LT((min_norm_point(corners).point - Vec3::UnitX()).norm(), 1e-15);
  for (Vec3& c : corners) c.x() -= 2;
  EXPECT_LT(min_norm_point(corners).point.norm(), 1e-8);
}

}  // namespace
}  // namespace aussois
