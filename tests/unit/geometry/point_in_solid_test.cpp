// SPDX-License-Identifier: Apache-2.0
// (CPX-13) against formulas of shapes, and against the solid angle under which a surface is seen.
#include "geometry/point_in_solid.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/random.hpp"
#include "tests/support/winding_number.hpp"

namespace aussois {
namespace {

bool is_inside(const SimplicialComplex& solid, const Vec3& p) {
  return is_inside(solid, connected_pieces(solid), p);
}

// All coordinates are those of vertices: points stand below and above vertices, edges, diagonals and faces,
// and beside walls along z.
TEST(PointInSolid, KnowsPointsThatProjectOntoVerticesAndEdges) {
  const SimplicialComplex box = make_box(2, 2, 2, 8);  // a vertex every quarter
  int inside = 0, all = 0;
  for (double x = -1.25; x <= 1.25; x += 0.125)
    for (double y = -1.25; y <= 1.25; y += 0.125)
      for (double z = -1.25; z <= 1.25; z += 0.125) {
        const Vec3 p(x, y, z);
        const double size = p.lpNorm<Eigen::Infinity>();
        if (size == 1) continue;  // on the surface
        ASSERT_EQ(is_inside(box, p), size < 1) << p.transpose();
        inside += size < 1, ++all;
      }
  EXPECT_EQ(inside, 15 * 15 * 15);
  EXPECT_EQ(all, 21 * 21 * 21 - (17 * 17 * 17 - 15 * 15 * 15));
}

// One rounding off the surface, in all directions, at any scale.
TEST(PointInSolid, KnowsTheSideOfPointsNextToTheSurface) {
  for (const double size : {1e-100, 1e-12, 1.0, 1e12, 1e100}) {
    const SimplicialComplex box = make_box(2 * size, 2 * size, 2 * size, 3);
    Random random(11);
    for (int i = 0; i < 600; ++i) {
      Vec3 p =
          size * (i % 2 == 0 ? random.vector(0.999) : Vec3(box.vertices[std::size_t(i) % 8] / size * 0.5));
      double& across = p[i % 3];
      const double face = i % 4 < 2 ? size : -size;
      across = std::nextafter(face, 0);
      ASSERT_TRUE(is_inside(box, p)) << size << ": " << p.transpose();
      across = std::nextafter(face, 2 * face);
      ASSERT_FALSE(is_inside(box, p)) << size << ": " << p.transpose();
    }
  }
}

// A corner of a face is split off by a triangle of height 1e-13: its neighbours' planes say little there.
TEST(PointInSolid, KnowsTheSideOfPointsAboveSlivers) {
  const SimplicialComplex box = make_box(2, 2, 2);
  std::vector<Vec3> vertices = box.vertices.to_vector();
  std::vector<std::array<int, 3>> triangles;
  for (const auto& [a, b, c] : box.triangles) {  // each gets a vertex next to the middle of an edge
    const Vec3 &u = box.vertices[a], &v = box.vertices[b], &w = box.vertices[c];
    const int middle = int(vertices.size());
    const Vec3 x = 0.5 * (u + v) + 1e-13 * (w - 0.5 * (u + v));
    for (const auto& t : {std::array{a, b, middle}, std::array{b, c, middle}, std::array{c, a, middle}})
      triangles.push_back(t);
    vertices.push_back(x);
  }
  const SimplicialComplex cut = make_complex(vertices, triangles, {}, true);
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const auto& t = cut.triangles[std::size_t(i) % cut.triangles.size()];
    Vec3 p = Vec3::Zero();
    double sum = 0;
    for (const int corner : t) {
      const double weight = random.uniform();
      p += weight * cut.vertices[corner], sum += weight;
    }
    p /= sum;
    Eigen::Index across = 0;
    p.cwiseAbs().maxCoeff(&across);
    const double face = p[across] > 0 ? 1 : -1;
    for (const double off : {1e-15, 1e-13, 1e-10}) {
      p[across] = face * (1 - off);
      ASSERT_TRUE(is_inside(cut, p)) << p.transpose();
      p[across] = face * (1 + off);
      ASSERT_FALSE(is_inside(cut, p)) << p.transpose();
    }
  }
}

TEST(PointInSolid, AgreesWithTheSolidAngle) {
  Random random(3);
  const std::vector<SimplicialComplex> solids{make_torus(1, 0.3, 24, 12),
                                              make_extrusion(gear_profile(9, 0.8, 1), 0.6), make_sphere(1, 2),
                                              transformed_complex(make_nut(), {}, 1 / 0.008)};
  for (const SimplicialComplex& solid : solids) {
    const SimplicialComplex turned = transformed_complex(solid, random.pose(0.1));
    int inside = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = random.vector(1.2);
      const double turns = winding_number(turned, p);
      ASSERT_NEAR(turns, std::round(turns), 1e-9);  // all that sums of 1e4 angles can be off
      ASSERT_EQ(is_inside(turned, p), std::round(turns) > 0);
      inside += is_inside(turned, p);
    }
    EXPECT_GT(inside, 30);
    EXPECT_LT(inside, 900);
  }
}

// Shells count with the side that they face.
TEST(PointInSolid, CountsShells) {
  const SimplicialComplex room = hollow(make_box(8, 8, 8), make_box(6, 6, 6));
  const Vec3 in_wall(3.5, 0, 0), in_room(2.5, 0, 0), middle = Vec3::Zero();
  EXPECT_TRUE(is_inside(room, in_wall));
  EXPECT_FALSE(is_inside(room, in_room));
  const SimplicialComplex core = merged({room, make_box(2, 2, 2)}, true);
  EXPECT_TRUE(is_inside(core, in_wall));
  EXPECT_FALSE(is_inside(core, in_room));
  EXPECT_TRUE(is_inside(core, middle));
  // Not repaired: a shell within another that faces outwards too, and one beside that faces inwards
  EXPECT_TRUE(is_inside(merged({make_box(8, 8, 8), make_box(2, 2, 2)}, true), middle));
  EXPECT_FALSE(is_inside(merged({make_box(8, 8, 8), inside_out(moved(make_box(2, 2, 2), 9, 0, 0))}, true),
                         Vec3(9, 0, 0)));
}

TEST(Pieces, AreWhatSharesVertices) {
  const SimplicialComplex box = make_box(2, 2, 2);
  std::vector<Vec3> vertices{Vec3(9, 9, 9)};  // alone
  vertices.insert(vertices.end(), box.vertices.begin(), box.vertices.end());
  vertices.insert(vertices.end(), {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(7, 1, 0)});
  std::vector<std::array<int, 3>> triangles;
  for (const auto& [a, b, c] : box.triangles) triangles.push_back({a + 1, b + 1, c + 1});
  const Pieces pieces = connected_pieces(make_complex(vertices, triangles, {{10, 11}, {9, 10}}));
  EXPECT_EQ(pieces.vertex, (std::vector{0, 1, 9}));
  EXPECT_EQ(pieces.of_vertex, (std::vector{0, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2}));
  EXPECT_EQ(pieces.box[1].lo, Vec3(-1, -1, -1));
  EXPECT_EQ(pieces.box[2].hi, Vec3(7, 1, 0));
  EXPECT_EQ(pieces.box[0].lo, pieces.box[0].hi);
}

}  // namespace
}  // namespace aussois
