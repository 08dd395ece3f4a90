// SPDX-License-Identifier: Apache-2.0
#include "geometry/surface_tree.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

double distance_to_box(const Vec3& p, const Vec3& half) {  // negative inside
  const Vec3 d = p.cwiseAbs() - half;
  return d.cwiseMax(0).norm() + std::min(0.0, d.maxCoeff());
}

TEST(SurfaceTree, SignedDistanceOfABoxIsTheFormula) {
  const Vec3 half(2, 1.5, 1);
  const SimplicialComplex box = make_box(4, 3, 2, 5);
  const SurfaceTree tree(box);
  Random random(7);
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = random.vector(3);
    const double expected = distance_to_box(p, half);
    inside += expected < 0;
    EXPECT_NEAR(tree.signed_distance(p), expected, 1e-14);
  }
  EXPECT_GT(inside, 300);
  EXPECT_LT(inside, 4700);
}

TEST(SurfaceTree, NamesTheSimplexThatCarriesTheNearestPoint) {
  const SimplicialComplex box = make_box(2, 2, 2);
  const SurfaceTree tree(box);
  const SurfacePoint corner = tree.nearest(Vec3(2, 2, 2));
  EXPECT_EQ(corner.dim, 0);
  EXPECT_EQ(box.vertices[corner.simplex], Vec3(1, 1, 1));
  const SurfacePoint edge = tree.nearest(Vec3(2, 2, 0.3));
  ASSERT_EQ(edge.dim, 1);
  const auto& [a, b] = box.edges[edge.simplex];
  EXPECT_LT((box.vertices[a] + box.vertices[b] - Vec3(2, 2, 0)).norm(), 1e-15);
  EXPECT_EQ(tree.nearest(Vec3(2, 0.3, 0.1)).dim, 2);
}

TEST(SurfaceTree, RaysLeaveThroughTheOppositeFace) {
  const SimplicialComplex box = make_box(4, 3, 2, 4);
  const SurfaceTree tree(box);
  const std::optional<double> out = tree.first_exit(Vec3(-2, 0.1, 0.2), Vec3::UnitX(), 0, 0.5);
  ASSERT_TRUE(out);
  EXPECT_NEAR(*out, 4, 1e-14);
  EXPECT_FALSE(tree.first_exit(Vec3(3, 0, 0), Vec3::UnitX(), 0, 0.5));
  const Vec3 slanted = Vec3(1, 0, 0.4).normalized();
  EXPECT_FALSE(tree.first_exit(Vec3(0, 0.1, 0.2), slanted, 0, 0.95)) << "no face is that square to the ray";
}

TEST(SurfaceTree, NeedsTriangles) {
  const SimplicialComplex point = make_point();
  EXPECT_NE(message_of([&] { SurfaceTree tree(point); }).find("triangles"), std::string::npos);
}

}  // namespace
}  // namespace aussois
