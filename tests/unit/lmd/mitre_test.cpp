// SPDX-License-Identifier: Apache-2.0
#include "lmd/mitre.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

// The planes of a cone over the polygon of these rays, counter-clockwise seen from outside.
std::vector<VertexPlane> cone_over(const std::vector<Vec3>& rays) {
  std::vector<VertexPlane> planes;
  for (std::size_t i = 0; i < rays.size(); ++i)
    planes.push_back({rays[i].cross(rays[(i + 1) % rays.size()]).normalized(), rays[i].normalized()});
  return planes;
}

double distance(const Vec3& p, const VertexPlane& plane) {
  return plane.normal.dot(p) - plane.offset;
}

TEST(Mitre, OfACubeCornerIsTheDiagonal) {
  const auto m = mitre(cone_over({{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}));
  ASSERT_TRUE(m);
  ASSERT_EQ(m->points.size(), 1U);
  EXPECT_LT((m->points[0] + Vec3(1, 1, 1)).norm(), 1e-14);
}

TEST(Mitre, OfAFlatVertexFollowsTheNormalAndOfACreaseTheBisector) {
  const auto flat = mitre(std::vector<VertexPlane>{{Vec3::UnitZ(), Vec3::UnitX()}});
  ASSERT_TRUE(flat);
  EXPECT_LT((flat->points[0] + Vec3::UnitZ()).norm(), 1e-15);
  const auto crease =
      mitre(std::vector<VertexPlane>{{Vec3::UnitZ(), -Vec3::UnitY()}, {Vec3::UnitX(), Vec3::UnitY()}});
  ASSERT_TRUE(crease);
  EXPECT_LT((crease->points[0] + Vec3(1, 0, 1)).norm(), 1e-15);
}

// Planes through the points of a paraboloid-like cone over random convex polygons: the solid below is convex,
// so the moved solid is the set { n_k . x <= -1 for all k } and its vertices keep all planes.
TEST(Mitre, OfConvexVerticesIsTheIntersectionOfTheHalfSpaces) {
  int split = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int d = 4 + random.index(5);
    std::vector<Vec3> rays;
    const double sx = random.uniform(0.5, 2), sy = random.uniform(0.5, 2);
    for (int i = 0; i < d; ++i) {  // on an ellipse, so the polygon is convex
      const double angle = 2 * kPi * (i + random.uniform(-0.3, 0.3)) / d;
      rays.emplace_back(sx * std::cos(angle), sy * std::sin(angle), -1);
    }
    const std::vector<VertexPlane> planes = cone_over(rays);
    for (const VertexPlane& plane : planes) ASSERT_GT(plane.normal.z(), 0);
    const auto m = mitre(planes);
    ASSERT_TRUE(m);
    split += m->points.size() > 1;
    for (const Vec3& p : m->points)
      for (const VertexPlane& plane : planes) EXPECT_LT(distance(p, plane), 1e-9);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      ASSERT_FALSE(m->of_plane[i].empty());
      for (int p : m->of_plane[i]) EXPECT_NEAR(distance(m->points[std::size_t(p)], planes[i]), 0, 1e-9);
      EXPECT_EQ(m->of_plane[i].back(), m->of_plane[(i + 1) % planes.size()].front()) << "one edge, one end";
    }
  }
  EXPECT_GT(split, 150) << "the sample is meant to need splits";
}

// The same cone as a pit in a solid: the planes move apart, and what they bound is again { -n_k . x <= 1 }.
TEST(Mitre, OfAPitIsTheIntersectionOfTheOtherHalfSpaces) {
  const std::vector<Vec3> pit = {{0, -1, -1}, {-2, -0.1, -1}, {0.1, 1, -1}, {2, 0.2, -1}};
  const std::vector<VertexPlane> planes = cone_over(pit);
  for (const VertexPlane& plane : planes) ASSERT_LT(plane.normal.z(), 0);
  const auto m = mitre(planes);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->points.size(), 2U);
  for (const Vec3& p : m->points)
    for (const VertexPlane& plane : planes) EXPECT_GT(distance(p, plane), -1e-9);
}

TEST(Mitre, WithoutSplitsDeviatesOrRefuses) {
  const std::vector<VertexPlane> planes = cone_over({{-3, -2, -2}, {3, -2, -2}, {3, 2, -2}, {-3, 2, -2}});
  EXPECT_FALSE(mitre(planes, {.deviation = 1e-3, .split = false}));
  const auto m = mitre(planes, {.deviation = 0.5, .split = false});
  ASSERT_TRUE(m);
  ASSERT_EQ(m->points.size(), 1U);
  double worst = 0;
  for (const VertexPlane& plane : planes) worst = std::max(worst, std::abs(distance(m->points[0], plane)));
  EXPECT_GT(worst, 1e-3);
  EXPECT_NEAR(m->deviation, worst, 1e-15);
}

}  // namespace
}  // namespace aussois
