// SPDX-License-Identifier: Apache-2.0
// Clearance maps against every vertex and triangle, swept volumes against formulas.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/drivers/assembly/clearance_map.hpp"
#include "examples/drivers/assembly/swept_volume.hpp"
#include "geometry/primitives.hpp"
#include "geometry/surface_tree.hpp"
#include "io/mesh_file.hpp"
#include "lmd/lmd_shape.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

std::vector<SE3> wobbling_path(Random& random, int poses) {
  std::vector<SE3> out{translation(0, 0, 1.6)};
  for (int k = 1; k < poses; ++k) {
    Vec6 move;
    move << random.vector(0.04), random.vector(0.05);
    move[2] += k < poses / 2 ? -0.01 : 0.03;
    out.push_back(out.back() * exp_se3(move));
  }
  return out;
}

// The record of every vertex is that of all poses, whatever was not asked again.
TEST(ClearanceMap, IsTheLeastDistanceOfAllPoses) {
  Random random(11);
  const SimplicialComplex part = make_torus(0.5, 0.2, 24, 12), other = make_box(1, 1.2, 0.8);
  const LmdShape a = prepare({.complex = part, .radius = 0}), b = prepare({.complex = other, .radius = 0});
  const SurfaceTree tree(other);
  for (int trial = 0; trial < 5; ++trial) {
    ClearanceMapper mapper(a, b, 10), again(a, b, 10, 3);
    std::vector<double> least(part.vertices.size(), 10);
    const std::vector<SE3> path = wobbling_path(random, 40);
    for (const SE3& g : path) {
      mapper.add(g), again.add(g);
      for (std::size_t i = 0; i < least.size(); ++i)
        least[i] = std::min(least[i], tree.nearest(g * part.vertices[i]).distance);
    }
    for (std::size_t i = 0; i < least.size(); ++i) {
      EXPECT_NEAR(mapper.map().distance[i], least[i], 1e-12);
      const SE3& g = path[std::size_t(mapper.map().pose[i])];
      EXPECT_NEAR(tree.nearest(g * part.vertices[i]).distance, least[i], 1e-12);
    }
    EXPECT_EQ(mapper.map().distance, again.map().distance);
    EXPECT_LT(mapper.asked(), std::int64_t(40 * least.size()) * 9 / 10);
  }
}

// Between two poses a vertex is never nearer than its record less what is told.
TEST(ClearanceMap, IsNeverAboveTheTruthBetweenPoses) {
  Random random(12);
  const SimplicialComplex part = make_box(0.3, 0.2, 0.1), other = make_box(1, 1, 1);
  const LmdShape a = prepare({.complex = part, .radius = 0}), b = prepare({.complex = other, .radius = 0});
  const SurfaceTree tree(other);
  const std::vector<SE3> path = wobbling_path(random, 60);
  ClearanceMapper mapper(a, b, 10);
  for (const SE3& g : path) mapper.add(g);
  for (std::size_t k = 1; k < path.size(); ++k)
    for (int s = 1; s < 20; ++s)
      for (std::size_t i = 0; i < part.vertices.size(); ++i) {
        const Vec3 x = std::lerp(0, 1, s / 20.0) * (path[k] * part.vertices[i]) +
                       (1 - s / 20.0) * (path[k - 1] * part.vertices[i]);
        EXPECT_GE(tree.nearest(x).distance, mapper.map().distance[i] - mapper.map().between - 1e-15);
      }
}

TEST(ClearanceMap, IsWrittenAsAMesh) {
  const SimplicialComplex part = make_box(1, 1, 1);
  ClearanceMap map{.distance = std::vector<double>(part.vertices.size(), 0.25), .pose = {}, .between = 0};
  const std::filesystem::path path = fresh_folder() / "clearance.ply";
  write_clearance_ply(path, part, map, 1);
  EXPECT_EQ(read_mesh(path, 1).triangles.size(), part.triangles.size());
  expect_names(content_of(path), "property double quality");
  expect_names(content_of(path), " 0.25 59 82 139\n");
}

// A ball along a line: a capsule. The true one is inside, and no swept cell is farther off than told.
TEST(SweptVolume, OfABallAlongALineIsACapsule) {
  constexpr double r = 0.5, length = 2;
  const SimplicialComplex ball = make_sphere(r, 4);
  std::vector<SE3> path;
  for (int k = 0; k <= 100; ++k) path.push_back(translation(length * k / 100, 0, 0));
  const SweptVolume swept = swept_volume(ball, path, 64, 2);
  const double exact = kPi * r * r * length + 4 * kPi / 3 * r * r * r,
               surface = 2 * kPi * r * length + 4 * kPi * r * r;
  EXPECT_GT(swept.volume, exact * 0.99);  // the mesh is inscribed
  EXPECT_LT(swept.volume, exact + surface * 2 * swept.cell);
  for (std::size_t i = 0; i < swept.swept.size(); ++i) {
    const auto nx = std::size_t(swept.cells[0]), ny = std::size_t(swept.cells[1]);
    const Vec3 x =
        swept.corner +
        swept.cell * (Vec3(double(i % nx), double(i / nx % ny), double(i / (nx * ny))) + Vec3::Constant(0.5));
    const double off = (x - Vec3(std::clamp(x.x(), 0.0, length), 0, 0)).norm() - r;
    if (off < -0.02) {
      EXPECT_TRUE(swept.swept[i]);
    }
    if (swept.swept[i]) {
      EXPECT_LE(off, swept.error);
    }
  }
}

// A square plate turned by a right angle about its corner's vertical line: a quarter of a disc and what
// sticks out.
TEST(SweptVolume, OfABoxThatTurnsIsAQuarterOfADisc) {
  const SimplicialComplex box = make_box(1, 1, 0.5);
  std::vector<SE3> path;
  for (int k = 0; k <= 180; ++k)
    path.push_back(rotation(Vec3::UnitZ(), kPi / 2 * k / 180) * translation(0.5, 0.5, 0));
  const SweptVolume swept = swept_volume(box, path, 96, 2);
  const double r = std::sqrt(2),
               area = kPi * r * r / 4 + 1;  // the sector of the diagonal, and half a square on each side
  EXPECT_GT(swept.volume, area * 0.5);
  EXPECT_LT(swept.volume, area * 0.5 + (2 * area + 0.5 * 7) * 2 * swept.cell);
}

TEST(SweptVolume, IsWrittenAsAClosedSurface) {
  const SweptVolume swept = swept_volume(make_box(1, 0.5, 0.25), {SE3{}, translation(0.2, 0, 0)}, 16);
  const std::filesystem::path path = fresh_folder() / "swept.obj";
  write_swept_obj(path, swept);
  const MeshFile back = read_mesh(path, 1);
  double volume = 0;
  for (const auto& t : back.triangles)
    volume += back.vertices[t[0]].dot(back.vertices[t[1]].cross(back.vertices[t[2]])) / 6;
  EXPECT_NEAR(volume, swept.volume, 1e-9);
}

TEST(SweptVolume, RefusesWhatSweepsNothing) {
  SimplicialComplex sheet = make_plate(1, 1);
  expect_names(message_of([&] { (void)swept_volume(sheet, {SE3{}}); }), "must be a solid");
  expect_names(message_of([&] { (void)swept_volume(make_box(1, 1, 1), {SE3{}}, 3); }),
               "n = 3 must lie in [4, 512]");
  expect_names(message_of([&] { (void)swept_volume(make_box(1, 1, 1), {}); }), "must be a pose");
}

}  // namespace
}  // namespace aussois
