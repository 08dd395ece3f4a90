// SPDX-License-Identifier: Apache-2.0
// Volume meshes: volumes and surfaces of the simple ones, and each refusal.
#include "geometry/volume_mesh.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/simplicial_complex.hpp"
#include "geometry/volume_primitives.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

double whole_volume(const VolumeMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets) sum += volume(mesh, t);
  for (const Hex& h : mesh.hexes) sum += volume(mesh, h);
  return sum;
}
// Of the surface, which must be closed and face outwards.
double enclosed_volume(const VolumeMesh& mesh) {
  return signed_volume(make_complex(mesh.points, boundary_triangles(mesh), {}, true));
}

TEST(VolumeMesh, OfABoxHasItsVolumeAndItsSurface) {
  for (const CellKind kind : {CellKind::tets, CellKind::hexes}) {
    const VolumeMesh mesh = make_box_mesh({1, 2, 3}, {2, 3, 4}, kind);
    validate(mesh);
    EXPECT_NEAR(whole_volume(mesh), 6, 1e-13);
    EXPECT_NEAR(enclosed_volume(mesh), 6, 1e-13);
    EXPECT_EQ(boundary_triangles(mesh).size(), 2 * 2 * (2 * 3 + 3 * 4 + 4 * 2));
    EXPECT_EQ(mesh.cells(), kind == CellKind::tets ? 6 * 24 : 24);
  }
}

TEST(VolumeMesh, OfRoundBodiesTendsToTheirVolumeWithTheSquareOfTheCells) {
  for (const CellKind kind : {CellKind::tets, CellKind::hexes}) {
    const auto errors = [&](int n) {
      const std::vector<std::pair<VolumeMesh, double>> all{
          {make_cylinder_mesh(1, 2, n, 2, kind), 2 * kPi},
          {make_ball_mesh(1, n, kind), 4 * kPi / 3},
          {make_shell_octant_mesh(1, 2, n, n, kind), 7 * kPi / 6}};
      std::vector<double> out;
      for (const auto& [mesh, exact] : all) {
        validate(mesh);
        EXPECT_NEAR(whole_volume(mesh), enclosed_volume(mesh),
                    (kind == CellKind::tets ? 1e-12 : 2e-2) * exact);
        out.push_back(1 - whole_volume(mesh) / exact);
      }
      return out;
    };
    const std::vector<double> coarse = errors(4), fine = errors(8);
    for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_NEAR(coarse[i] / fine[i], 4, 0.6) << i;
  }
}

TEST(VolumeMesh, GradientsOfAHexahedronAreThoseOfLinearFunctions) {
  VolumeMesh mesh = make_box_mesh({1, 1, 1}, {1, 1, 1}, CellKind::hexes);
  for (std::size_t i = 0; i < 8; ++i)
    mesh.points[i] +=
        0.1 * Vec3(std::sin(3.0 * double(i)), std::cos(5.0 * double(i)), std::sin(7.0 * double(i)));
  for (const HexPoint& p : hex_points(mesh, mesh.hexes[0])) {
    Mat3 of_place = Mat3::Zero();
    for (std::size_t a = 0; a < 8; ++a) of_place += mesh.points[mesh.hexes[0][a]] * p.gradient[a].transpose();
    EXPECT_LT((of_place - Mat3::Identity()).norm(), 1e-13);
  }
}

TEST(VolumeMesh, RefusesWhatIsNoSolidByName) {
  const VolumeMesh good = make_box_mesh({1, 1, 1}, {2, 1, 1});
  const auto message = [&](auto&& change) {
    VolumeMesh mesh = good;
    change(mesh);
    return message_of([&] { validate(mesh); });
  };
  EXPECT_EQ(message([](VolumeMesh&) {}), "");
  expect_names(message([](VolumeMesh& m) { m.tets.clear(); }), "has no cells");
  expect_names(message([](VolumeMesh& m) { m.tets[3][1] = 99; }),
               "tetrahedron 3: corner = 99 must lie in [0, 12)");
  expect_names(message([](VolumeMesh& m) { m.tets[3][1] = m.tets[3][0]; }), "stand for one corner only");
  expect_names(message([](VolumeMesh& m) { m.points.emplace_back(0, 0, 0); }),
               "point 12 is in no cell; there are 1");
  expect_names(message([](VolumeMesh& m) { m.points[5].x() = std::nan(""); }), "point 5 must be finite");
  expect_names(message([](VolumeMesh& m) { std::swap(m.tets[2][0], m.tets[2][1]); }),
               "tetrahedron 2 must have a volume above");
  expect_names(message([](VolumeMesh& m) { m.tets.push_back(m.tets[0]); }),
               "has a face that more than two cells have");
  expect_names(message([](VolumeMesh& m) { m.group_of = {1}; }), "group_of.size() = 1 must be 0 or 12");
  // Two tetrahedra that meet in one point, and two that meet in an edge
  const VolumeMesh at_a_point{
      .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
      .tets = {{0, 1, 2, 3}, {0, 5, 4, 6}}};
  VolumeMesh turned = at_a_point;
  if (volume(turned, turned.tets[1]) < 0) std::swap(turned.tets[1][0], turned.tets[1][1]);
  expect_names(message_of([&] { validate(turned); }),
               "point 0 joins parts that share no face there; there are 1");
}

TEST(VolumeMesh, IsTurnedIfAllCellsAreInsideOut) {
  for (const CellKind kind : {CellKind::tets, CellKind::hexes}) {
    const VolumeMesh good = make_box_mesh({1, 1, 1}, {2, 2, 2}, kind);
    VolumeMesh mesh = good;
    EXPECT_EQ(turn_outside_out(mesh), 0);
    for (Vec3& x : mesh.points) x.x() *= -1;
    EXPECT_EQ(turn_outside_out(mesh), int(good.cells()));
    validate(mesh);
    for (Vec3& x : mesh.points) x.x() *= -1;
    if (kind == CellKind::tets) std::swap(mesh.tets[0][0], mesh.tets[0][1]);  // one is the right way round
    for (std::size_t k = 0; k < 4 && kind == CellKind::hexes; ++k)
      std::swap(mesh.hexes[0][k], mesh.hexes[0][k + 4]);
    EXPECT_EQ(turn_outside_out(mesh), 0);
  }
}

TEST(VolumePrimitives, RefuseBadArgumentsByName) {
  expect_names(message_of([] { make_box_mesh({1, 0, 1}, {1, 1, 1}); }), "make_box_mesh: size = 0 must");
  expect_names(message_of([] {
                 make_box_mesh({1, 1, 1}, {1, 0, 1});
               }),
               "make_box_mesh: cells = 0 must lie in [1, 1024]");
  expect_names(message_of([] { make_ball_mesh(1, 3); }), "make_ball_mesh: across = 3 must be even");
  expect_names(message_of([] { make_cylinder_mesh(1, 1, 2, 0); }), "make_cylinder_mesh: along = 0");
  expect_names(message_of([] { make_shell_octant_mesh(2, 1, 2, 2); }), "outer - inner = -1 must");
}

}  // namespace
}  // namespace aussois
