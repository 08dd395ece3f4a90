// SPDX-License-Identifier: Apache-2.0
// Question 12 of doc/theory/lmd.md: parts like those of assemblies come back from erosion and dilation with
// their faces and concave edges, their convex edges rounded by (ERO-5).
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "io/mesh_file.hpp"
#include "lmd/erosion.hpp"

namespace aussois {
namespace {

void expect_restored(const SimplicialComplex& solid, double depth, const std::string& name) {
  SCOPED_TRACE(name);
  const double size = bounding_box(solid).diagonal();
  const ErosionResult r = erode(solid, {.depth = depth, .deviation = 0, .samples = 20'000});
  ASSERT_TRUE(r.ok()) << r.reason;
  const ErosionMeasures& m = r.measures;
  EXPECT_LT(m.face_error, 1e-12 * size);
  EXPECT_LT(m.edge_error, 1e-12 * size);
  EXPECT_LT(m.shallow, 1e-12 * size);
  EXPECT_GE(m.rounding, m.edge_rounding - 1e-12 * size);
  EXPECT_LE(m.rounding, m.rounding_bound + 1e-12 * size);
  EXPECT_EQ(m.deviating_vertices, 0);
  EXPECT_GT(m.samples, 20'000);
  EXPECT_GT(m.face_samples, m.samples / 20) << "the faces are judged";
}

SimplicialComplex shared_mesh(const std::string& name) {
  const char* folder = std::getenv("AUSSOIS_DATA_DIR");
  if (!folder || !*folder) return {};
  MeshFile file = read_mesh(std::filesystem::path(folder) / "meshes" / (name + ".obj"), 1e-3);
  weld_mesh_file(file);
  return make_complex(std::move(file.vertices), std::move(file.triangles));
}

TEST(ErosionOfParts, GivesBackFacesAndConcaveEdgesOfOurOwn) {
  const std::vector<Vec2> l = {{0, 0}, {0.03, 0}, {0.03, 0.01}, {0.01, 0.01}, {0.01, 0.03}, {0, 0.03}};
  expect_restored(make_box(0.04, 0.03, 0.02, 7), 1e-3, "box");
  expect_restored(make_extrusion(l, 0.01), 1e-3, "L");
  expect_restored(make_extrusion(gear_profile(20, 0.02, 0.024), 0.01), 2e-4, "gear");
  expect_restored(make_cylinder(0.004, 0.05, 64), 1e-4, "peg");
  expect_restored(make_sphere(0.01, 3), 2e-4, "ball");
  expect_restored(make_torus(0.02, 0.005, 48, 24), 2e-4, "ring");
}

TEST(ErosionOfParts, GivesBackFacesAndConcaveEdgesOfSharedMeshes) {
  if (shared_mesh("tslot_rail").triangles.empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no shared data";
  for (const char* name : {"tslot_rail", "tslot_slider_c02", "gear_608", "gear_pin", "press_p1", "press_p2",
                           "press_p3", "press_p4", "piston_crank"}) {
    const SimplicialComplex part = shared_mesh(name);
    expect_restored(part, 1e-3 * bounding_box(part).diagonal(), name);
  }
}

// Twisted facets, and thread ends that planes cut to feather edges and facets of some micrometres: these
// vanish one after the other while the planes move. 15e-6 is three tenths of the pair's clearance.
TEST(ErosionOfParts, GivesBackFacesAndConcaveEdgesOfABoltAndItsNut) {
  for (const double depth : {1e-5, 1.5e-5, 5e-5, 6e-5}) {
    expect_restored(make_bolt(), depth, "bolt, " + std::to_string(1e6 * depth) + " um");
    expect_restored(make_nut(), depth, "nut, " + std::to_string(1e6 * depth) + " um");
  }
}

// 22 000 and 12 500 triangles in files of seven digits, from which planes and edges differ by rounding.
TEST(ErosionOfParts, ErodesTheSharedBoltAndNut) {
  if (shared_mesh("bolt_m16").triangles.empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no shared data";
  for (const auto& [name, depth] :
       {std::pair("bolt_m16", 2e-5), std::pair("nut_m16_c050", 1.5e-5), std::pair("nut_m16_c050", 5e-5)}) {
    SCOPED_TRACE(name);
    const SimplicialComplex part = shared_mesh(name);
    const ErosionResult r = erode(part, {.depth = depth, .samples = 20'000});
    ASSERT_TRUE(r.ok()) << r.reason;
    EXPECT_LT(r.measures.face_error, 1e-3 * depth);
    EXPECT_LE(r.measures.shallow, 2e-3 * depth) << "twice the accepted deviation";
    EXPECT_LT(r.measures.rounding, 4 * depth) << "at the feather edges";
    EXPECT_GT(r.measures.merged_vertices, 0);
  }
}

// Files with rounded digits: faces are as exact as the planes meet (1e-6 depths), or, where vertices may
// deviate and saddles are split, as the accepted deviation.
TEST(ErosionOfParts, FollowsTheDigitsOfSharedMeshes) {
  if (shared_mesh("bearing_inner").triangles.empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no shared data";
  struct Case {
    std::string name{};
    double depth = 0, bound = 0;
  };
  for (const auto& [name, depth, bound] : {Case{"bearing_inner", 1.25e-5, 1e-6}, Case{"alpha15", 5e-5, 1e-3},
                                           Case{"alpha20", 1.7e-4, 1e-3}, Case{"piston_head", 1e-4, 1e-3}}) {
    SCOPED_TRACE(name);
    const ErosionResult r = erode(shared_mesh(name), {.depth = depth, .samples = 20'000});
    ASSERT_TRUE(r.ok()) << r.reason;
    EXPECT_LT(r.measures.face_error, bound * depth);
  }
}

}  // namespace
}  // namespace aussois
