// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/change.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

const std::vector<Vec2> kL = {{0, 0}, {0.03, 0}, {0.03, 0.01}, {0.01, 0.01}, {0.01, 0.03}, {0, 0.03}};

// Every expected place is a vertex, and there is no other.
void expect_vertices(const SimplicialComplex& k, const std::vector<Vec3>& expected, double tolerance) {
  EXPECT_EQ(k.vertices.size(), expected.size());
  for (const Vec3& x : expected) {
    double nearest = kInf;
    for (const Vec3& v : k.vertices) nearest = std::min(nearest, (v - x).norm());
    EXPECT_LT(nearest, tolerance) << x.transpose();
  }
}

TEST(Erosion, OfABoxIsTheSmallerBox) {
  const ErosionResult r = erode(make_box(0.04, 0.03, 0.02), {.depth = 1e-3});
  ASSERT_TRUE(r.ok()) << r.reason;
  std::vector<Vec3> expected;
  for (double x : {-0.019, 0.019})
    for (double y : {-0.014, 0.014})
      for (double z : {-0.009, 0.009}) expected.emplace_back(x, y, z);
  expect_vertices(r.complex, expected, 1e-16);
  EXPECT_TRUE(r.complex.solid);
}

TEST(Erosion, RoundsABoxByTheFormulae) {
  const double eps = 1e-3, size = make_box(0.04, 0.03, 0.02).vertices[0].norm() * 2;
  const ErosionMeasures m = erode(make_box(0.04, 0.03, 0.02), {.depth = eps}).measures;
  EXPECT_NEAR(m.edge_rounding, (std::sqrt(2.0) - 1) * eps, 1e-12 * size);  // (ERO-5) at 90 degrees
  EXPECT_NEAR(m.rounding_bound, (std::sqrt(3.0) - 1) * eps, 1e-12 * size);
  EXPECT_NEAR(m.rounding, m.rounding_bound, 1e-12 * size);
  EXPECT_NEAR(m.hausdorff, m.rounding, 1e-12 * size);
  EXPECT_LT(m.face_error, 1e-12 * size);
  EXPECT_LT(m.edge_error, 1e-12 * size);
  EXPECT_LT(m.shallow, 1e-12 * size);
  EXPECT_NEAR(m.thickness, 0.018, 1e-12);
  // Along the edges (1 - pi / 4) eps^2; the corners are of the order eps^3, which (ERO-9) leaves out.
  const double edges = 4 * (0.04 + 0.03 + 0.02) * (1 - kPi / 4) * eps * eps;
  EXPECT_NEAR(m.volume_lost, edges, 1e-12 * edges);
  const double a = 0.038, b = 0.028, c = 0.018;  // Steiner's formula for the dilated eroded box
  const double left = a * b * c + 2 * eps * (a * b + b * c + c * a) + kPi * eps * eps * (a + b + c) +
                      4 * kPi / 3 * eps * eps * eps;
  EXPECT_NEAR(m.volume_lost, 0.04 * 0.03 * 0.02 - left, 8 * eps * eps * eps);
}

TEST(Erosion, OfAnLIsTheLMovedIn) {
  const double e = 1e-3;
  const ErosionResult r = erode(make_extrusion(kL, 0.01), {.depth = e});
  ASSERT_TRUE(r.ok()) << r.reason;
  std::vector<Vec3> expected;
  for (double z : {-0.004, 0.004})
    for (const Vec2& x : {Vec2(e, e), Vec2(0.03 - e, e), Vec2(0.03 - e, 0.01 - e), Vec2(0.01 - e, 0.01 - e),
                          Vec2(0.01 - e, 0.03 - e), Vec2(e, 0.03 - e)})
      expected.emplace_back(x.x(), x.y(), z);
  expect_vertices(r.complex, expected, 1e-16);
  EXPECT_EQ(r.measures.concave_chains, 1);
  EXPECT_EQ(r.measures.convex_chains, 17);
}

// Points of the eroded L plus a ball, against the inequalities of the L.
TEST(Erosion, TheDilatedSolidStaysInsideTheSolid) {
  const double e = 1e-3;
  const ErosionResult r = erode(make_extrusion(kL, 0.01), {.depth = e});
  ASSERT_TRUE(r.ok());
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const auto& [a, b, c] = r.complex.triangles[random.index(int(r.complex.triangles.size()))];
    double s = random.uniform(), t = random.uniform();
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3 y = (1 - s - t) * r.complex.vertices[a] + s * r.complex.vertices[b] +
                   t * r.complex.vertices[c] + e * random.direction();
    const double outside = std::max({-y.x(), -y.y(), y.x() - 0.03, y.y() - 0.03, std::abs(y.z()) - 0.005,
                                     std::min(y.x() - 0.01, y.y() - 0.01)});
    ASSERT_LT(outside, 1e-16) << y.transpose();
  }
}

TEST(Erosion, DoesNotDependOnTheTriangulation) {
  const double eps = 2e-3;  // deeper than the cells of the fine box: its inner vertices are passed
  const ErosionResult fine = erode(make_box(0.04, 0.03, 0.02, 32), {.depth = eps});
  ASSERT_TRUE(fine.ok()) << fine.reason;
  EXPECT_NEAR(signed_volume(fine.complex), 0.036 * 0.026 * 0.016, 1e-18);
  const Box box = bounding_box(fine.complex);
  EXPECT_LT((box.hi - Vec3(0.018, 0.013, 0.008)).norm(), 1e-16);
  EXPECT_NEAR(fine.measures.rounding, (std::sqrt(3.0) - 1) * eps, 1e-14);
}

// Vertices inside faces and edges are off them by up to sqrt(3)/2 digits, so triangles 4.1 mm high slope by
// up to 4.2e-6. Each moves in by the depth; only what it moves along its face, sqrt(2) depths at corners,
// times the slope is lost.
TEST(Erosion, FollowsTheRoundedDigitsOfAFile) {
  const SimplicialComplex box = make_box(0.04, 0.03, 0.02, 4);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> vertices;
  for (const Vec3& x : box.vertices) vertices.push_back((turn * x * 1e8).array().round() / 1e8);
  const SimplicialComplex file = make_complex(vertices, box.triangles, {}, true);
  const ErosionResult r = erode(file, {.depth = 1e-4});
  ASSERT_TRUE(r.ok()) << r.reason;
  double off = 0;
  for (std::size_t t = 0; t < file.triangles.size(); ++t)
    for (int v : file.triangles[t]) {
      const auto region = std::size_t(r.ideal.triangle_region[t]);
      off = std::max(
          off, std::abs(r.ideal.region_normal[region].dot(file.vertices[v]) - r.ideal.region_offset[region]));
    }
  EXPECT_EQ(r.ideal.region_normal.size(), 6U);
  EXPECT_GT(off, 5e-9);
  EXPECT_LT(r.measures.face_error, 6e-6 * 1e-4);
  EXPECT_EQ(r.complex.triangles.size(), file.triangles.size());
}

// A pyramid over a rectangle of sides 2 a > 2 b: the four planes of its sides do not meet when moved, and the
// top becomes a ridge along x, from the two steeper planes.
TEST(Erosion, SplitsTheTopOfAPyramidIntoARidge) {
  const double a = 0.03, b = 0.02, h = 0.02, eps = 1e-3;
  const SimplicialComplex pyramid =
      make_complex({{-a, -b, 0}, {a, -b, 0}, {a, b, 0}, {-a, b, 0}, {0, 0, h}},
                   {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}, {}, true);
  const ErosionResult r = erode(pyramid, {.depth = eps});
  ASSERT_TRUE(r.ok()) << r.reason;
  EXPECT_EQ(r.measures.split_vertices, 1);
  const double z = h - eps * std::hypot(h, b) / b;
  const double x = (a * (h - z) - eps * std::hypot(h, a)) / h;
  ASSERT_GT(x, 0);
  const double down = eps;  // the base moves up
  std::vector<Vec3> expected = {{x, 0, z}, {-x, 0, z}};
  const double xb = a - (eps * std::hypot(h, a) + a * down) / h,
               yb = b - (eps * std::hypot(h, b) + b * down) / h;
  for (double sx : {-1.0, 1.0})
    for (double sy : {-1.0, 1.0}) expected.emplace_back(sx * xb, sy * yb, down);
  expect_vertices(r.complex, expected, 1e-15);
  EXPECT_LT(r.measures.face_error, 1e-15);
}

TEST(Erosion, RoundSurfacesAreExactWithSplitsAndDeviateWithout) {
  const SimplicialComplex ball = make_sphere(0.01, 2);
  const double size = bounding_box(ball).diagonal();
  const ErosionResult split = erode(ball, {.depth = 2e-4, .deviation = 0});
  ASSERT_TRUE(split.ok()) << split.reason;
  EXPECT_GT(split.measures.split_vertices, 100);
  EXPECT_LT(split.measures.face_error, 1e-12 * size);
  EXPECT_LE(split.measures.rounding, split.measures.rounding_bound * (1 + 1e-9));
  const ErosionResult whole = erode(ball, {.depth = 2e-4, .deviation = 1e-2, .split = false});
  ASSERT_TRUE(whole.ok()) << whole.reason;
  EXPECT_EQ(whole.complex.triangles.size(), ball.triangles.size());
  EXPECT_EQ(whole.measures.split_vertices, 0);
  EXPECT_GT(whole.measures.deviating_vertices, 100);
  EXPECT_LE(whole.measures.shallow, whole.measures.deviation * (1 + 1e-6));
  EXPECT_GT(whole.measures.face_error, 1e-6 * 2e-4) << "the deviation is there, and measured";
  EXPECT_EQ(erode(ball, {.depth = 2e-4, .deviation = 0, .split = false}).status,
            ErosionStatus::unsettled_vertex);
}

// A cube with one corner cut off so little that the cut would vanish: what is left is the eroded cube.
TEST(Erosion, AFacetThatVanishesLeavesTheOthers) {
  const double eps = 1e-3, c = 1e-4;
  const SimplicialComplex cube = make_complex({{0, 0, 0},
                                               {1e-2, 0, 0},
                                               {1e-2, 1e-2, 0},
                                               {0, 1e-2, 0},
                                               {0, 0, 1e-2},
                                               {1e-2, 0, 1e-2},
                                               {0, 1e-2, 1e-2},
                                               {1e-2 - c, 1e-2, 1e-2},
                                               {1e-2, 1e-2 - c, 1e-2},
                                               {1e-2, 1e-2, 1e-2 - c}},
                                              {{0, 2, 1},
                                               {0, 3, 2},
                                               {0, 1, 5},
                                               {0, 5, 4},
                                               {0, 4, 6},
                                               {0, 6, 3},
                                               {4, 5, 8},
                                               {4, 8, 7},
                                               {4, 7, 6},
                                               {1, 2, 9},
                                               {1, 9, 8},
                                               {1, 8, 5},
                                               {3, 6, 7},
                                               {3, 7, 9},
                                               {3, 9, 2},
                                               {7, 8, 9}},
                                              {}, true);
  const ErosionResult r = erode(cube, {.depth = eps});
  ASSERT_TRUE(r.ok()) << r.reason;
  EXPECT_EQ(r.measures.merged_vertices, 3);
  std::vector<Vec3> expected;
  for (double x : {eps, 1e-2 - eps})
    for (double y : {eps, 1e-2 - eps})
      for (double z : {eps, 1e-2 - eps}) expected.emplace_back(x, y, z);
  expect_vertices(r.complex, expected, 1e-16);
  EXPECT_EQ(erode(cube, {.depth = eps, .contract = false}).status, ErosionStatus::lost_edge);
}

// A box whose upper long edge is broken by a chamfer so narrow that its two long edges pass each other: the
// face becomes a line and vanishes, and what is left is the eroded box.
TEST(Erosion, ANarrowChamferVanishesAlongItsWholeLength) {
  const double eps = 1e-3, c = 4e-4;
  const std::vector<Vec2> profile = {{0, 0}, {0.03, 0}, {0.03, 0.02 - c}, {0.03 - c, 0.02}, {0, 0.02}};
  const ErosionResult r = erode(make_extrusion(profile, 0.04), {.depth = eps, .deviation = 0});
  ASSERT_TRUE(r.ok()) << r.reason;
  std::vector<Vec3> expected;
  for (double x : {eps, 0.03 - eps})
    for (double y : {eps, 0.02 - eps})
      for (double z : {-0.02 + eps, 0.02 - eps}) expected.emplace_back(x, y, z);
  expect_vertices(r.complex, expected, 1e-16);
  EXPECT_LT(r.measures.face_error, 1e-15);
  EXPECT_LT(r.measures.shallow, 1e-15);
}

// A ring of chamfers about the end of a prism of 12 sides, all of which vanish at the same depth.
TEST(Erosion, ARingOfNarrowChamfersVanishesAtOnce) {
  const int n = 12;
  const double eps = 1e-3, c = 3e-4, radius = 0.01, height = 0.02;
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (const auto& [r, z] :
       {std::pair(radius, 0.0), std::pair(radius, height - c), std::pair(radius - c, height)})
    for (int i = 0; i < n; ++i)
      vertices.emplace_back(r * std::cos(2 * kPi * i / n), r * std::sin(2 * kPi * i / n), z);
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    for (int level : {0, n}) {
      triangles.push_back({level + i, level + j, level + n + j});
      triangles.push_back({level + i, level + n + j, level + n + i});
    }
    if (i > 0 && j > 0) {
      triangles.push_back({0, j, i});
      triangles.push_back({2 * n, 2 * n + i, 2 * n + j});
    }
  }
  const ErosionResult r = erode(make_complex(vertices, triangles, {}, true), {.depth = eps, .deviation = 0});
  ASSERT_TRUE(r.ok()) << r.reason;
  const double inner = radius - eps / std::cos(kPi / n);
  std::vector<Vec3> expected;
  for (double z : {eps, height - eps})
    for (int i = 0; i < n; ++i)
      expected.emplace_back(inner * std::cos(2 * kPi * i / n), inner * std::sin(2 * kPi * i / n), z);
  expect_vertices(r.complex, expected, 1e-14);
}

// The wall of a step lower than the depth keeps its height between a concave and a convex edge.
TEST(Erosion, AStepLowerThanTheDepthMovesInAsItIs) {
  const double eps = 1e-3, step = 2e-4;
  const std::vector<Vec2> profile = {{0, 0},       {0.04, 0},           {0.04, 0.02},
                                     {0.03, 0.02}, {0.03, 0.02 + step}, {0, 0.02 + step}};
  const ErosionResult r = erode(make_extrusion(profile, 0.02), {.depth = eps, .deviation = 0});
  ASSERT_TRUE(r.ok()) << r.reason;
  EXPECT_EQ(r.complex.vertices.size(), 12U);
  EXPECT_LT(r.measures.face_error, 1e-15);
}

TEST(Erosion, OfAVertexWhereTwoSolidsTouchPartsThem) {
  const SimplicialComplex box = make_box(2, 2, 2);
  std::vector<Vec3> vertices;  // two boxes that share the corner at the origin
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> index[2];
  for (int side = 0; side < 2; ++side)
    for (const Vec3& x : box.vertices) {
      const Vec3 y = x + (side ? 1 : -1) * Vec3(1, 1, 1);
      if (side && y.isZero()) {
        index[1].push_back(int(std::find(vertices.begin(), vertices.end(), y) - vertices.begin()));
        continue;
      }
      index[side].push_back(int(vertices.size()));
      vertices.push_back(y);
    }
  for (const auto& one : index)
    for (const auto& [a, b, c] : box.triangles) triangles.push_back({one[a], one[b], one[c]});
  const ErosionResult r = erode(make_complex(vertices, triangles, {}, true), {.depth = 0.1});
  ASSERT_TRUE(r.ok()) << r.reason;
  EXPECT_EQ(r.complex.vertices.size(), 16U);
  EXPECT_NEAR(signed_volume(r.complex), 2 * 1.8 * 1.8 * 1.8, 1e-12);
}

TEST(Erosion, RefusesAThinPlateWithItsThickness) {
  for (double thickness : {1e-3, 1.9e-3, 2e-3}) {
    const ErosionResult r = erode(make_box(0.04, 0.03, thickness), {.depth = 1e-3});
    EXPECT_FALSE(r.ok());
    EXPECT_NEAR(r.thickness, thickness, 1e-12);
    EXPECT_NE(r.reason.find("sheet"), std::string::npos) << r.reason;
    EXPECT_NE(r.reason.find("region"), std::string::npos) << r.reason;
    EXPECT_TRUE(r.complex.triangles.empty());
  }
  EXPECT_TRUE(erode(make_box(0.04, 0.03, 2.001e-3), {.depth = 1e-3}).ok());
}

TEST(Erosion, RefusesThinWallsOfThickParts) {
  // A channel whose floor, then whose left wall, is thinner than twice the depth; the rest is thick.
  for (const auto& [floor, wall] : {std::pair(1.5e-3, 5e-3), std::pair(5e-3, 1.5e-3)}) {
    const std::vector<Vec2> channel = {{0, 0},         {0.03, 0},     {0.03, 0.02}, {0.025, 0.02},
                                       {0.025, floor}, {wall, floor}, {wall, 0.02}, {0, 0.02}};
    const ErosionResult r = erode(make_extrusion(channel, 0.02), {.depth = 1e-3});
    EXPECT_FALSE(r.ok());
    EXPECT_NEAR(r.thickness, 1.5e-3, 1e-12);
  }
}

TEST(Erosion, RefusesWhatIsLessThanTheBall) {
  const ErosionResult r = erode(make_box(1e-3, 1e-3, 1e-3), {.depth = 1e-3});
  EXPECT_FALSE(r.ok());
  EXPECT_NEAR(r.thickness, 1e-3, 1e-12);
  EXPECT_FALSE(erode(make_sphere(0.01, 2), {.depth = 0.02}).ok());
}

TEST(Erosion, RefusesWhatIsNoSolid) {
  EXPECT_EQ(erode(make_plate(1, 1), {.depth = 0.1}).status, ErosionStatus::not_solid);
  SimplicialComplex inside_out = make_box(1, 1, 1);
  change_each(inside_out.triangles, [](auto& t) { std::swap(t[0], t[1]); });
  inside_out = make_complex(inside_out.vertices, inside_out.triangles);
  EXPECT_EQ(erode(inside_out, {.depth = 0.1}).status, ErosionStatus::not_solid);
  const SimplicialComplex one = make_box(1, 1, 1);  // two boxes through each other
  const ErosionResult r = erode(merged({one, moved(one, 0.5, 0.3, 0.2)}, true), {.depth = 0.1});
  EXPECT_EQ(r.status, ErosionStatus::not_solid);
  EXPECT_NE(r.reason.find("pass through"), std::string::npos);
}

TEST(Erosion, RefusesMoreRoundingThanAllowed) {
  const ErosionResult r = erode(make_box(4, 3, 2), {.depth = 0.1, .max_rounding = 0.05});
  EXPECT_EQ(r.status, ErosionStatus::too_round);
  EXPECT_NEAR(r.measures.rounding, 0.0732050807568877, 1e-12);
  EXPECT_TRUE(erode(make_box(4, 3, 2), {.depth = 0.1, .max_rounding = 0.0733}).ok());
}

TEST(Erosion, FindsTheDepthByWhichARefusedSolidCanBeEroded) {
  // A plate down to half its thickness, where nothing is left; a box until its corners lose sqrt(3) - 1
  // depths.
  EXPECT_EQ(erodible_depth(make_box(0.04, 0.03, 1e-3), {.depth = 1e-3}), 4.9e-4);
  EXPECT_EQ(erodible_depth(make_box(0.04, 0.03, 1e-3), {.depth = 0.4}), 4.9e-4);
  EXPECT_EQ(erodible_depth(make_box(4, 3, 2), {.depth = 0.1, .max_rounding = 0.05}), 0.068);
  EXPECT_EQ(erodible_depth(make_box(4, 3, 2), {.depth = 0.1, .max_rounding = 1e-9}), std::nullopt);
  EXPECT_EQ(erodible_depth(make_plate(1, 1), {.depth = 0.1}), std::nullopt);
}

TEST(Erosion, BadOptionsAreNamed) {
  const SimplicialComplex box = make_box(1, 1, 1);
  const auto message = [&](const ErosionOptions& o) { return message_of([&] { erode(box, o); }); };
  EXPECT_NE(message({}).find("ErosionOptions::depth = 0"), std::string::npos);
  EXPECT_NE(message({.depth = 0.1, .planarity = 1}).find("ErosionOptions::planarity = 1"), std::string::npos);
  EXPECT_NE(message({.depth = 0.1, .meet = 0}).find("ErosionOptions::meet = 0"), std::string::npos);
  EXPECT_NE(message({.depth = 0.1, .deviation = 2}).find("ErosionOptions::deviation = 2"), std::string::npos);
  EXPECT_NE(message({.depth = 0.1, .max_rounding = 0}).find("ErosionOptions::max_rounding"),
            std::string::npos);
  EXPECT_NE(message({.depth = 0.1, .samples = 0}).find("ErosionOptions::samples = 0"), std::string::npos);
}

TEST(Erosion, MeasuresSeeAWrongResult) {
  const SimplicialComplex box = make_box(4, 3, 2);
  const double eps = 0.1;
  const ErosionMeasures shifted =
      measure_erosion(box, transformed_complex(make_box(3.8, 2.8, 1.8), translation(0.01, 0, 0)), eps, 1000);
  EXPECT_NEAR(shifted.shallow, 0.01, 1e-12);
  EXPECT_NEAR(shifted.face_error, 0.01, 1e-12);
  const ErosionMeasures small = measure_erosion(box, make_box(3.7, 2.8, 1.8), eps, 1000);
  EXPECT_NEAR(small.face_error, 0.05, 1e-12);
  EXPECT_NEAR(small.shallow, 0, 1e-15);
}

}  // namespace
}  // namespace aussois
