// SPDX-License-Identifier: Apache-2.0
#include "lmd/mitre.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>
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
      for (int p : m->of_plane[i]) EXPECT_NEAR(distance(m->points[p], planes[i]), 0, 1e-9);
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

// A vertex with as many planes as a fine cone has: the moved solid is the intersection of the half-spaces.
TEST(Mitre, OfManyPlanesIsTheIntersectionOfTheHalfSpaces) {
  Random random(7);
  std::vector<Vec3> rays;
  const int d = 40;
  for (int i = 0; i < d; ++i) {
    const double angle = 2 * kPi * (i + random.uniform(-0.2, 0.2)) / d;
    rays.emplace_back(1.5 * std::cos(angle), std::sin(angle), -1);
  }
  const std::vector<VertexPlane> planes = cone_over(rays);
  const auto m = mitre(planes);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->points.size(), std::size_t(d - 2));
  for (const Vec3& p : m->points)
    for (const VertexPlane& plane : planes) EXPECT_LT(distance(p, plane), 1e-9);
}

// Six times the volume between a plane far below and the parts of the planes near the vertex, up to a
// constant, by tetrahedra over the borders of the planes; none unless each border is simple. An independent,
// slow way.
std::optional<double> volume_of(const std::vector<VertexPlane>& planes, const Mitre& m) {
  const double reach = 1e4;
  double volume = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Vec3 &n = planes[i].normal, &after = planes[(i + 1) % planes.size()].spoke, &own = planes[i].spoke;
    std::vector<Vec3> line;
    for (auto p = m.of_plane[i].rbegin(); p != m.of_plane[i].rend(); ++p) line.push_back(m.points[*p]);
    const Vec3 first = line.front(), last = line.back();
    line.insert(line.begin(), first + (reach - after.dot(first)) * after);
    line.push_back(last + (reach - own.dot(last)) * own);
    const auto side = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      return (b - a).cross(c - a).dot(n);
    };
    for (std::size_t j = 0; j + 1 < line.size(); ++j)
      for (std::size_t k = j + 2; k + 1 < line.size(); ++k)
        if (side(line[j], line[j + 1], line[k]) * side(line[j], line[j + 1], line[k + 1]) < 0 &&
            side(line[k], line[k + 1], line[j]) * side(line[k], line[k + 1], line[j + 1]) < 0)
          return std::nullopt;
    for (std::size_t k = 0; k < line.size(); ++k)
      volume += planes[i].offset * n.dot(line[k].cross(line[(k + 1) % line.size()]));
  }
  return volume;
}

// All ways to split a vertex of five planes: five pairs of diagonals.
std::vector<Mitre> splits_of_five(const std::vector<VertexPlane>& planes) {
  std::vector<Mitre> all;
  for (int apex = 0; apex < 5; ++apex) {  // the diagonals of each leave one corner
    Mitre m;
    m.of_plane.resize(5);
    for (int t = 0; t < 3; ++t) {
      const int b = (apex + 1 + t) % 5, c = (apex + 2 + t) % 5;
      Mat3 n;
      n << planes[apex].normal.transpose(), planes[b].normal.transpose(), planes[c].normal.transpose();
      m.points.push_back(n.partialPivLu().solve(Vec3::Constant(-1)));
      m.of_plane[b].insert(m.of_plane[b].begin(), t);
      m.of_plane[c].push_back(t);
    }
    m.of_plane[apex] = {2, 1, 0};
    for (std::size_t i = 1; i < 5; ++i) std::ranges::sort(m.of_plane[(std::size_t(apex) + i) % 5]);
    all.push_back(std::move(m));
  }
  return all;
}

TEST(Mitre, OfASaddleIsTheSplitOfTheLargestSolid) {
  int split = 0, several = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Vec3> rays;
    for (int i = 0; i < 5; ++i) {
      const double angle = 2 * kPi * (i + random.uniform(-0.3, 0.3)) / 5;
      rays.emplace_back(std::cos(angle), std::sin(angle), random.uniform(-0.6, 0.6));
    }
    const std::vector<VertexPlane> planes = cone_over(rays);
    double most = -kInf;
    int embedded = 0;
    for (const Mitre& m : splits_of_five(planes))
      if (const auto volume = volume_of(planes, m)) most = std::max(most, *volume), ++embedded;
    const auto m = mitre(planes);
    if (embedded == 0) continue;
    ASSERT_TRUE(m) << embedded;
    const auto volume = volume_of(planes, *m);
    ASSERT_TRUE(volume);
    EXPECT_NEAR(*volume, most, 1e-6 * std::abs(most));
    ++split;
    several += embedded > 1;
  }
  EXPECT_GT(split, 250);
  EXPECT_GT(several, 5) << "the sample is meant to have choices";
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
