// SPDX-License-Identifier: Apache-2.0
#include "geometry/simplicial_complex.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "geometry/dilated_shape.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Edge = std::array<int, 2>;
using Triangle = std::array<int, 3>;

const std::vector<Vec3> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kTetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

std::vector<int> items(const Incidence& incidence, int row) {
  return {incidence[row].begin(), incidence[row].end()};
}

std::string refusal(std::vector<Vec3> vertices, std::vector<Triangle> triangles, std::vector<Edge> wires = {},
                    bool solid = false) {
  return message_of([&] { make_complex(vertices, triangles, wires, solid); });
}

TEST(SimplicialComplex, OfATetrahedronListsItsSimplicesInOrder) {
  const SimplicialComplex complex = make_complex(kCorners, kTetrahedron, {}, true);
  EXPECT_EQ(complex.vertices, kCorners);
  EXPECT_EQ(complex.triangles, kTetrahedron);
  EXPECT_EQ(complex.edges, (std::vector<Edge>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(complex.triangle_edges, (std::vector<Triangle>{{1, 3, 0}, {0, 4, 2}, {3, 5, 4}, {1, 2, 5}}));
  EXPECT_EQ(items(complex.edge_triangles, 0), (std::vector<int>{0, 1}));
  EXPECT_EQ(items(complex.edge_triangles, 5), (std::vector<int>{2, 3}));
  EXPECT_EQ(items(complex.vertex_edges, 2), (std::vector<int>{1, 3, 5}));
  EXPECT_EQ(items(complex.vertex_triangles, 3), (std::vector<int>{1, 2, 3}));
  EXPECT_TRUE(complex.solid);
  EXPECT_DOUBLE_EQ(signed_volume(complex), 1.0 / 6);
}

TEST(SimplicialComplex, MixesPointsWiresAndTriangles) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {5, 5, 5}};
  const SimplicialComplex complex = make_complex(vertices, {{0, 1, 2}}, {{3, 1}, {1, 3}, {1, 0}});
  EXPECT_EQ(complex.edges, (std::vector<Edge>{{0, 1}, {0, 2}, {1, 2}, {1, 3}}));  // each wire once
  EXPECT_EQ(items(complex.edge_triangles, 0), std::vector<int>{0});
  EXPECT_TRUE(items(complex.edge_triangles, 3).empty());
  EXPECT_TRUE(items(complex.vertex_edges, 4).empty());
  EXPECT_TRUE(items(complex.vertex_triangles, 4).empty());
  EXPECT_FALSE(complex.solid);
  EXPECT_FALSE(is_closed_oriented(complex));
}

TEST(SimplicialComplex, MayBeEmptyOrASinglePointButIsThenNotClosed) {
  EXPECT_TRUE(make_complex({}, {}).edges.empty());
  EXPECT_FALSE(is_closed_oriented(make_point()));
}

// The definition, read off directly: every list against a look at all simplices.
TEST(SimplicialComplex, IncidencesAreThoseOfTheDefinition) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const int n = 4 + random.index(12);
    std::vector<Vec3> vertices;
    for (int i = 0; i < n; ++i) vertices.push_back(random.vector(1));
    const auto pick = [&] { return random.index(n); };
    std::vector<Triangle> triangles;
    std::vector<Edge> wires;
    for (int i = 0; i < 2 * n; ++i) {
      const Triangle t = {pick(), pick(), pick()};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
      const Edge e = {pick(), pick()};
      if (e[0] != e[1]) wires.push_back(e);
    }
    const SimplicialComplex complex = make_complex(vertices, triangles, wires);

    std::set<Edge> edges;
    const auto ascending = [](int a, int b) { return Edge{std::min(a, b), std::max(a, b)}; };
    for (const Edge& e : wires) edges.insert(ascending(e[0], e[1]));
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) edges.insert(ascending(t[k], t[(k + 1) % 3]));
    ASSERT_EQ(complex.edges, std::vector<Edge>(edges.begin(), edges.end()));

    const auto contains = [](const auto& simplex, int v) {
      return std::find(simplex.begin(), simplex.end(), v) != simplex.end();
    };
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(complex.edges[complex.triangle_edges[t][k]],
                  ascending(triangles[t][k], triangles[t][(k + 1) % 3]));
    for (int e = 0; e < int(complex.edges.size()); ++e) {
      const Edge& ends = complex.edges[e];
      std::vector<int> expected;
      for (int t = 0; t < int(triangles.size()); ++t)
        if (contains(triangles[t], ends[0]) && contains(triangles[t], ends[1])) expected.push_back(t);
      EXPECT_EQ(items(complex.edge_triangles, e), expected);
    }
    for (int v = 0; v < n; ++v) {
      std::vector<int> expected_edges, expected_triangles;
      for (int e = 0; e < int(complex.edges.size()); ++e)
        if (contains(complex.edges[e], v)) expected_edges.push_back(e);
      for (int t = 0; t < int(triangles.size()); ++t)
        if (contains(triangles[t], v)) expected_triangles.push_back(t);
      EXPECT_EQ(items(complex.vertex_edges, v), expected_edges);
      EXPECT_EQ(items(complex.vertex_triangles, v), expected_triangles);
    }
  }
}

TEST(SimplicialComplex, EdgesDoNotDependOnTheOrderOfTheTriangles) {
  const SimplicialComplex torus = make_torus(1, 0.3, 12, 9);
  std::vector<Triangle> shuffled = torus.triangles.to_vector();
  Random random(5);
  for (std::size_t i = shuffled.size() - 1; i > 0; --i)
    std::swap(shuffled[i], shuffled[random.bits() % (i + 1)]);
  ASSERT_NE(shuffled, torus.triangles);
  const SimplicialComplex again = make_complex(torus.vertices, shuffled, {}, true);
  EXPECT_EQ(again.edges, torus.edges);
  EXPECT_EQ(again.triangles, shuffled);
}

TEST(SimplicialComplex, OfMoreThanAHundredThousandTrianglesIsBuilt) {  // 0.04 s in release
  const SimplicialComplex torus = make_torus(1, 0.3, 260, 250);
  EXPECT_EQ(torus.triangles.size(), 130000u);
  EXPECT_EQ(torus.edges.size(), 195000u);
  EXPECT_TRUE(is_closed_oriented(torus));
}

TEST(SimplicialComplex, NamesTheFirstBadSimplex) {
  EXPECT_EQ(refusal(kCorners, {{0, 1, 2}, {0, 1, 4}}), "triangle 1: vertex index = 4 must lie in [0, 4)");
  EXPECT_EQ(refusal(kCorners, {{0, -1, 2}}), "triangle 0: vertex index = -1 must lie in [0, 4)");
  EXPECT_EQ(refusal(kCorners, {{0, 1, 0}}), "triangle 0 repeats vertex 0");
  EXPECT_EQ(refusal(kCorners, {{0, 1, 1}}), "triangle 0 repeats vertex 1");
  EXPECT_EQ(refusal(kCorners, {}, {{0, 1}, {2, 2}}), "wire 1 repeats vertex 2");
  EXPECT_EQ(refusal(kCorners, {}, {{0, 9}}), "wire 0: vertex index = 9 must lie in [0, 4)");
  EXPECT_EQ(refusal({{0, 0, 0}, {0, kInf, 1}}, {}), "vertex 1 = (0 inf 1) must be finite");
  EXPECT_NE(refusal({{std::nan(""), 0, 0}}, {}), "");
}

TEST(SimplicialComplex, TakesTheWordSolidOnlyFromClosedSurfacesFacingOutwards) {
  std::vector<Triangle> open = kTetrahedron;
  open.pop_back();
  EXPECT_NE(refusal(kCorners, open, {}, true).find("3 of 6 edges"), std::string::npos);
  std::vector<Triangle> twisted = kTetrahedron;
  std::swap(twisted[0][0], twisted[0][1]);
  EXPECT_NE(refusal(kCorners, twisted, {}, true).find("3 of 6 edges"), std::string::npos);
  std::vector<Triangle> tripled = kTetrahedron;
  tripled.push_back(tripled[0]);
  EXPECT_NE(refusal(kCorners, tripled, {}, true).find("3 of 6 edges"), std::string::npos);
  std::vector<Vec3> with_antenna = kCorners;
  with_antenna.push_back({0, 0, 2});
  EXPECT_NE(refusal(with_antenna, kTetrahedron, {{3, 4}}, true).find("1 of 7 edges"), std::string::npos);
  std::vector<Triangle> inside_out = kTetrahedron;
  for (Triangle& t : inside_out) std::swap(t[0], t[1]);
  EXPECT_NE(refusal(kCorners, inside_out, {}, true).find("face inwards"), std::string::npos);
  EXPECT_NE(refusal(kCorners, {}, {}, true), "");
  EXPECT_EQ(refusal(kCorners, open), "");
  EXPECT_EQ(refusal(kCorners, inside_out), "");
}

TEST(SimplicialComplex, VolumeDoesNotSufferFarFromTheOrigin) {
  const SimplicialComplex far =
      transformed_complex(make_box(0.01, 0.01, 0.01), translation(1000, -2000, 3000));
  EXPECT_NEAR(signed_volume(far), 1e-6, 1e-6 * 1e-9);  // coordinates are rounded at 4.5e-13 of 0.01
}

TEST(SimplicialComplex, TransformationScalesThenMoves) {
  const SimplicialComplex box = make_box(1, 2, 3);
  const SE3 g = translation(10, 0, 0) * rotation({0, 0, 1}, kPi / 2);
  const SimplicialComplex moved = transformed_complex(box, g, 2);
  EXPECT_LT((bounding_box(moved).lo - Vec3(8, -1, -3)).norm(), 1e-14);
  EXPECT_LT((bounding_box(moved).hi - Vec3(12, 1, 3)).norm(), 1e-14);
  EXPECT_EQ(moved.edges, box.edges);
  EXPECT_TRUE(moved.solid);
  EXPECT_NEAR(radius_about(moved, {10, 0, 0}), std::sqrt(14.0), 1e-14);
  EXPECT_DOUBLE_EQ(bounding_box(box).diagonal(), std::sqrt(14.0));
  EXPECT_THROW(transformed_complex(box, g, 0), std::invalid_argument);
  EXPECT_THROW(transformed_complex(box, g, -1), std::invalid_argument);  // would turn a solid inside out
  EXPECT_THROW(transformed_complex(box, g, kInf), std::invalid_argument);
}

TEST(DilatedShape, RefusesARadiusThatIsNotALengthAndAnEmptyComplex) {
  EXPECT_EQ(dilate(make_point(), 0.5).radius, 0.5);
  EXPECT_EQ(dilate(make_point(), 0).radius, 0);
  EXPECT_EQ(dilate(make_segment(2), 0.5).complex.edges.size(), 1u);
  EXPECT_THROW(dilate(make_point(), -1e-9), std::invalid_argument);
  EXPECT_THROW(dilate(make_point(), kInf), std::invalid_argument);
  EXPECT_THROW(dilate(make_point(), std::nan("")), std::invalid_argument);
  EXPECT_THROW(dilate(SimplicialComplex{}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
