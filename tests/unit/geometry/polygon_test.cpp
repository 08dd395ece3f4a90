// SPDX-License-Identifier: Apache-2.0
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

std::vector<int> loop(int from, int count) {
  std::vector<int> list(static_cast<std::size_t>(count));
  std::iota(list.begin(), list.end(), from);
  return list;
}

// Sum of the areas of the triangles, each of which must be positive.
double area_of(const std::vector<Vec2>& points, const std::vector<std::array<int, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double area = twice_area(points, {a, b, c}) / 2;
    EXPECT_GT(area, 0);
    sum += area;
  }
  return sum;
}

TEST(Segment, IsNearestAtItsFootOrAtAnEnd) {
  const Vec2 a(1, 1), b(3, 2);
  EXPECT_LT((nearest_on_segment(a, b, Vec2(2, 1.5) + 0.7 * Vec2(-1, 2)) - Vec2(2, 1.5)).norm(), 1e-15);
  EXPECT_EQ(nearest_on_segment(a, b, Vec2(-4, 0)), a);
  EXPECT_EQ(nearest_on_segment(a, b, Vec2(9, 9)), b);
  EXPECT_EQ(nearest_on_segment(a, a, Vec2(9, 9)), a);
  EXPECT_EQ(cross(Vec2(2, 0), Vec2(1, 3)), 6);
}

TEST(Polygon, PointsAlongAStraightSideMakeNoFlatTriangles) {
  const std::vector<Vec2> points = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 2}, {0, 2}};
  const auto triangles = triangulate(points, {loop(0, 6)});
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->size(), 4U);
  EXPECT_NEAR(area_of(points, *triangles), 6, 1e-14);
}

TEST(Polygon, HolesStayOpen) {
  std::vector<Vec2> points = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  std::vector<std::vector<int>> loops = {loop(0, 4)};
  for (const Vec2& corner : {Vec2(1, 1), Vec2(6, 1), Vec2(1, 6), Vec2(6, 6)}) {  // in rows: equal abscissas
    loops.push_back(loop(int(points.size()), 4));
    for (const Vec2& d : {Vec2(0, 0), Vec2(0, 3), Vec2(3, 3), Vec2(3, 0)}) points.push_back(corner + d);
  }
  const auto triangles = triangulate(points, loops);
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->size(), 4U + 4 * 4 + 2 * 4 - 2);  // Euler: corners + 2 holes - 2
  EXPECT_NEAR(area_of(points, *triangles), 100 - 4 * 9, 1e-12);
}

TEST(Polygon, RandomStarsWithHolesAreFilledExactly) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int n = 3 + random.index(40), m = random.index(2) ? 3 + random.index(20) : 0;
    std::vector<Vec2> points;
    for (int i = 0; i < n + m; ++i) {
      const bool hole = i >= n;
      const double angle = 2 * kPi * (hole ? -double(i - n) / m : double(i) / n);
      const double r = hole ? random.uniform(0.1, 0.45) : random.uniform(1.0, 3.0) / std::cos(kPi / n);
      points.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    std::vector<std::vector<int>> loops = {loop(0, n)};
    if (m) loops.push_back(loop(n, m));
    double expected = 0;
    for (const auto& l : loops) expected += twice_area(points, l) / 2;
    const auto triangles = triangulate(points, loops);
    ASSERT_TRUE(triangles);
    EXPECT_EQ(triangles->size(), std::size_t(n + m + (m ? 2 : 0) - 2));
    EXPECT_NEAR(area_of(points, *triangles), expected, 1e-12 * n);
  }
}

TEST(Polygon, ThatRunsTheWrongWayHasNoTriangles) {
  const std::vector<Vec2> points = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  EXPECT_FALSE(triangulate(points, {loop(0, 4)}));
}

}  // namespace
}  // namespace aussois
