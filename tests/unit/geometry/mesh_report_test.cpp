// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh_report.hpp"

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "geometry/self_intersections.hpp"
#include "tests/support/change.hpp"

namespace aussois {
namespace {

using Triangles = std::vector<std::array<int, 3>>;
using Pairs = std::vector<std::array<int, 2>>;

TEST(MeshReport, OfABoxSaysSolid) {
  const MeshReport report = report_mesh(make_box(0.01, 0.02, 0.03));
  EXPECT_EQ(report.vertices, 8);
  EXPECT_EQ(report.edges, 18);
  EXPECT_EQ(report.triangles, 12);
  EXPECT_EQ(report.components, 1);
  EXPECT_TRUE(report.closed && report.oriented && report.manifold && report.solid());
  EXPECT_NEAR(report.volume, 6e-6, 1e-20);
  EXPECT_NEAR(report.box.diagonal(), std::sqrt(1e-4 + 4e-4 + 9e-4), 1e-16);
  EXPECT_EQ(report.border_edges + report.misoriented_edges + report.degenerate_triangles +
                report.duplicate_vertices + report.duplicate_triangles + report.self_intersections,
            0);
}

TEST(MeshReport, OfAPlateCountsItsBorder) {
  const MeshReport report = report_mesh(make_plate(1, 1, 3, 2));
  EXPECT_EQ(report.border_edges, 10);
  EXPECT_FALSE(report.closed);
  EXPECT_TRUE(report.oriented && report.manifold);
  EXPECT_FALSE(report.solid());
  EXPECT_EQ(report.volume, 0);
}

TEST(MeshReport, OfAnInvertedBoxIsClosedAndNoSolid) {
  SimplicialComplex box = make_box(1, 1, 1);
  change_each(box.triangles, [](auto& triangle) { std::swap(triangle[0], triangle[1]); });
  const MeshReport report = report_mesh(make_complex(box.vertices, box.triangles));
  EXPECT_TRUE(report.closed && report.oriented);
  EXPECT_NEAR(report.volume, -1, 1e-15);
  EXPECT_FALSE(report.solid());
}

TEST(MeshReport, CountsTheThreeEdgesOfOneFlippedTriangle) {
  SimplicialComplex box = make_box(1, 1, 1);
  change(box.triangles, [](auto& all) { std::swap(all[5][0], all[5][1]); });
  const MeshReport report = report_mesh(make_complex(box.vertices, box.triangles));
  EXPECT_EQ(report.misoriented_edges, 3);
  EXPECT_TRUE(report.closed && report.manifold);
  EXPECT_FALSE(report.oriented || report.solid());
}

TEST(MeshReport, OfTheMoebiusStripIsManifoldAndNotOriented) {
  const Triangles strip = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}, {4, 5, 1}, {5, 0, 1}};
  std::vector<Vec3> corners;
  for (int k = 0; k < 3; ++k) {  // a strip that turns by pi around the ring
    const double angle = 2 * kPi * k / 3, turn = kPi * k / 3;
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    for (const int side : {-1, 1})
      corners.push_back(radial + 0.3 * side * (std::cos(turn) * radial + std::sin(turn) * Vec3::UnitZ()));
  }
  const MeshReport report = report_mesh(make_complex(corners, strip));
  EXPECT_TRUE(report.manifold);
  EXPECT_FALSE(report.oriented);
  EXPECT_GT(report.misoriented_edges, 0);
  EXPECT_EQ(report.border_edges, 6);
}

TEST(MeshReport, FindsEdgesAndVerticesWhereSheetsMeet) {
  // Three wings on one edge, and two triangles that share one vertex only.
  const std::vector<Vec3> vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0},
                                      {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {4, 0, 0},  {4, 1, 0}};
  const MeshReport report =
      report_mesh(make_complex(vertices, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {5, 6, 7}, {5, 8, 9}}));
  EXPECT_EQ(report.non_manifold_edges, 1);
  EXPECT_EQ(report.non_manifold_vertices, 1);
  EXPECT_EQ(report.components, 2);
  EXPECT_FALSE(report.manifold || report.oriented || report.closed);
  EXPECT_EQ(report.self_intersections, 0);
}

TEST(MeshReport, CountsWiresAndIsolatedVertices) {
  const MeshReport report =
      report_mesh(make_complex({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}}, {}, {{0, 1}, {1, 2}}));
  EXPECT_EQ(report.wire_edges, 2);
  EXPECT_EQ(report.isolated_vertices, 1);
  EXPECT_EQ(report.components, 2);
  EXPECT_FALSE(report.closed || report.oriented || report.manifold);
  EXPECT_EQ(report.min_height_ratio, 0);
}

TEST(MeshReport, OfAPointHasNoSizeAndNoComplaint) {
  const MeshReport report = report_mesh(make_point());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.isolated_vertices, 1);
  EXPECT_EQ(report.box.diagonal(), 0);
}

TEST(MeshReport, CountsDuplicates) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {1, 0, 0}};
  const MeshReport report = report_mesh(make_complex(vertices, {{0, 1, 2}, {2, 0, 1}, {2, 1, 0}, {3, 4, 2}}));
  EXPECT_EQ(report.duplicate_vertices, 2) << "minus zero is zero";
  EXPECT_EQ(report.duplicate_triangles, 2)
      << "in any rotation and orientation; the fourth has vertices of its own";
  EXPECT_EQ(report.self_intersections, 6) << "all four lie on each other";
}

TEST(MeshReport, JudgesDegeneracyByTheSizeOfThePart) {
  for (const double size : {1e-150, 1e-3, 1.0, 1e150}) {
    const auto sliver = [&](double height) {
      const std::vector<Vec3> vertices = {{0, 0, 0}, {size, 0, 0}, {0.4 * size, height * size, 0}};
      return report_mesh(make_complex(vertices, {{0, 1, 2}}));
    };
    EXPECT_EQ(sliver(2e-12).degenerate_triangles, 0) << size;
    EXPECT_EQ(sliver(0.5e-12).degenerate_triangles, 1) << size;
    EXPECT_EQ(sliver(0).degenerate_triangles, 1) << size;
    EXPECT_NEAR(sliver(1e-3).min_height_ratio, 1e-3, 1e-8) << size;
  }
}

TEST(MeshReport, TellsPeopleUnitsAndDefectsInWords) {
  const std::string solid = to_string(report_mesh(make_box(0.01, 0.02, 0.03)));
  EXPECT_NE(solid.find("box 10 x 20 x 30 mm"), std::string::npos) << solid;
  EXPECT_NE(solid.find("closed, oriented, manifold"), std::string::npos) << solid;
  EXPECT_NE(solid.find("volume 6e-06 m^3"), std::string::npos) << solid;
  EXPECT_EQ(solid.find("border"), std::string::npos) << solid;
  const std::string plate = to_string(report_mesh(make_plate(1, 1)));
  EXPECT_NE(plate.find("open, oriented, manifold"), std::string::npos) << plate;
  EXPECT_NE(plate.find("4 border edges"), std::string::npos) << plate;
}

// --- self-intersections
// ------------------------------------------------------------------------------------------

Pairs pairs_of(std::vector<Vec3> vertices, Triangles triangles) {
  return self_intersections(make_complex(std::move(vertices), std::move(triangles)));
}

TEST(SelfIntersections, AreNoneOnSmoothAndSharpSurfaces) {
  for (const SimplicialComplex& part :
       {make_box(1, 1, 1, 3), make_sphere(1, 3), make_torus(1, 0.3, 32, 12), make_plate(1, 2, 5, 5)})
    EXPECT_EQ(self_intersections(part), Pairs{});
}

TEST(SelfIntersections, OfTwoTrianglesFollowTheirPosition) {
  const auto with = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b, c}, {{0, 1, 2}, {3, 4, 5}});
  };
  const Pairs yes = {{0, 1}}, no = {};
  EXPECT_EQ(with({1, 1, -1}, {1, 1, 1}, {5, 5, 0}), yes) << "pierces";
  EXPECT_EQ(with({1, 1, 1}, {1, 1, 2}, {5, 5, 1}), no) << "above";
  EXPECT_EQ(with({1, 1, 1e-300}, {1, 1, 2}, {2, 1, 1}), no) << "above by less than any rounding";
  EXPECT_EQ(with({1, 1, 0}, {1, 1, 2}, {2, 1, 1}), yes) << "touches with a vertex";
  EXPECT_EQ(with({2, 0, 0}, {1, -1, 1}, {3, -1, 1}), yes) << "touches an edge: a T-junction";
  EXPECT_EQ(with({1, 1, 0}, {2, 1, 0}, {1, 2, 0}), yes) << "coplanar, inside";
  EXPECT_EQ(with({3, 3, 0}, {4, 3, 0}, {3, 4, 0}), no) << "coplanar, beside";
}

TEST(SelfIntersections, BeyondASharedVertexAreFound) {
  const auto with = [](const Vec3& a, const Vec3& b) {
    return pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b}, {{0, 1, 2}, {0, 3, 4}});
  };
  EXPECT_TRUE(with({-1, 0, 1}, {0, -1, 1}).empty());
  EXPECT_TRUE(with({-1, 0, 0}, {0, -1, 0}).empty()) << "coplanar, opposite";
  EXPECT_EQ(with({1, 1, 1}, {1, 1, -1}).size(), 1u)
      << "cuts through the first along a line from the shared vertex";
  EXPECT_EQ(with({1, 2, 0}, {2, 1, 0}).size(), 1u) << "coplanar, on it";
}

TEST(SelfIntersections, AcrossASharedEdgeMeansFoldedFlat) {
  const auto with = [](const Vec3& d) {
    return pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, d}, {{0, 1, 2}, {1, 0, 3}});
  };
  EXPECT_TRUE(with({0, -4, 0}).empty()) << "flat, opened";
  EXPECT_TRUE(with({0, 4, 1e-300}).empty()) << "a fold with an angle, however small";
  EXPECT_EQ(with({1, 5, 0}).size(), 1u) << "folded flat";
}

TEST(SelfIntersections, TakeEqualPlacesAsShared) {
  SimplicialComplex box = make_box(1, 1, 1, 2);
  std::vector<Vec3> split;
  Triangles triangles;
  for (const auto& [a, b, c] : box.triangles) {
    for (const int v : {a, b, c}) split.push_back(box.vertices[v]);
    const int last = int(split.size()) - 1;
    triangles.push_back({last - 2, last - 1, last});
  }
  EXPECT_TRUE(pairs_of(split, triangles).empty());
}

TEST(SelfIntersections, PassOverTrianglesWithoutArea) {
  EXPECT_TRUE(
      pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {1, 1, 3}}, {{0, 1, 2}, {3, 4, 5}})
          .empty());
}

TEST(SelfIntersections, StopAtTheirLimit) {
  std::vector<Vec3> vertices;
  Triangles triangles;
  for (int i = 0; i < 100; ++i) {  // all through one point: 4950 pairs
    const double angle = kPi * (i + 0.5) / 100;
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    vertices.insert(vertices.end(),
                    {Vec3(0, 0, 3), Vec3(-radial - Vec3::UnitZ()), Vec3(radial - Vec3::UnitZ())});
    vertices[vertices.size() - 3] += 1e-3 * radial;
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const SimplicialComplex star = make_complex(vertices, triangles);
  EXPECT_EQ(self_intersections(star).size(), 4950u);
  EXPECT_EQ(self_intersections(star, 10).size(), 10u);
  EXPECT_EQ(report_mesh(star).self_intersections, 4950);
}

// A box through a sphere: the search must find what looking at every pair of triangles alone finds.
TEST(SelfIntersections, OfTheTreeAreThoseOfAllPairs) {
  for (int n = 1; n <= 3; ++n) {
    SimplicialComplex both = make_sphere(1, n);
    const SimplicialComplex box =
        transformed_complex(make_box(1, 1.1, 1.3, n), translation(0.6, 0.3, 0.2) * rotation({1, 2, 3}, 0.7));
    const int shift = int(both.vertices.size()), cut = int(both.triangles.size());
    change(both.vertices,
           [&](auto& all) { all.insert(all.end(), box.vertices.begin(), box.vertices.end()); });
    change(both.triangles, [&](auto& all) {
      for (const auto& [i, j, k] : box.triangles) all.push_back({i + shift, j + shift, k + shift});
    });
    const auto corner = [&](int t, std::size_t k) { return both.vertices[both.triangles[t][k]]; };
    Pairs expected;
    for (int i = 0; i < cut; ++i)
      for (int j = cut; j < int(both.triangles.size()); ++j)
        if (!pairs_of({corner(i, 0), corner(i, 1), corner(i, 2), corner(j, 0), corner(j, 1), corner(j, 2)},
                      {{0, 1, 2}, {3, 4, 5}})
                 .empty())
          expected.push_back({i, j});
    EXPECT_GT(expected.size(), 10u);
    EXPECT_EQ(self_intersections(make_complex(both.vertices, both.triangles)), expected);
  }
}

TEST(FirstAtSamePlace, NamesTheEarliestVertex) {
  EXPECT_EQ(first_at_same_place(std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}}),
            (std::vector{0, 1, 0, 1, 0}));
  EXPECT_TRUE(first_at_same_place({}).empty());
}

}  // namespace
}  // namespace aussois
