// SPDX-License-Identifier: Apache-2.0
// The repair on the meshes that people really have: what becomes a solid, what does not and why, and that
// contacts of a repaired part are those of the surface in the file.
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "io/mesh_file.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shared_meshes.hpp"
#include "tests/support/winding_number.hpp"

namespace aussois {
namespace {

SimplicialComplex as_in_file(const std::filesystem::path& path) {
  const MeshFile mesh = read_mesh(path, 1e-3);
  return make_complex(mesh.vertices, mesh.triangles, mesh.wires);
}

class RepairedMeshes : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("AUSSOIS_DATA_DIR");
    if (!folder || !*folder) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
    data = folder;
  }
  std::filesystem::path data{};
};

struct Expected {
  bool solid = false;
  int welded_near = 0, slivers = 0, split = 0, turned_shells = 0;
};

// The files that are no solids as they are; all others must come back bit for bit. The counts of border edges
// and intersections before are those of the README beside the files (SharedMeshes in mesh_oracle_test).
const std::map<std::string, Expected> kRepaired = {
    {"ariac_insert.obj", {true, 0, 16, 0}},
    {"ariac_regulator.obj", {true, 0, 1, 0}},
    {"factory_gear_medium.obj", {true, 60, 2, 0}},
    {"factory_nut_m16_loose.obj", {true, 0, 0, 84}},
    {"ariac_insert_raw.stl", {true, 0, 16, 0}},
    {"factory_nut_m16_loose_raw.obj", {true, 0, 0, 84}},
    {"featuretype_open.stl", {true, 288, 0, 0}},
    {"multibody_inverted.stl", {true, 0, 0, 0, 2}},
    // Bodies that pass through each other
    {"factory_gear_base_loose.obj", {false, 0, 0, 60}},
    // Coordinates rounded to 1 um have folded triangles over each other: see the next test
    {"factory_hole_round_8mm.obj", {false, 0, 1, 28}},
    {"factory_hole_round_8mm_raw.obj", {false, 0, 1, 28}},
    // A corner of it folds over itself
    {"press_p5.obj", {false, 0, 1, 0}},
    {"codim_heightfield_points.obj", {}},
    {"codim_link_edges.obj", {}},
    {"codim_mat_edges.obj", {}},
    {"spring_wire.obj", {}}};

TEST_F(RepairedMeshes, AreSolidsUnlessTheyPassThroughThemselves) {
  int files = 0, solids = 0;
  for (const std::filesystem::path& path : shared_meshes(data)) {
    SCOPED_TRACE(path.filename().string());
    const SimplicialComplex mesh = as_in_file(path);
    const RepairedMesh repaired = repair_mesh(mesh);
    const RepairReport& r = repaired.report;
    const auto known = kRepaired.find(path.filename().string());
    const Expected expected = known == kRepaired.end() ? Expected{.solid = true} : known->second;
    EXPECT_EQ(repaired.complex.solid, expected.solid) << r.reason;
    EXPECT_EQ(r.welded_near.count, expected.welded_near);
    EXPECT_EQ(r.flipped_slivers.count + r.dropped_slivers.count, expected.slivers);
    EXPECT_EQ(r.split_edges.count, expected.split);
    EXPECT_EQ(r.turned_shells.count, expected.turned_shells);
    EXPECT_EQ(r.after.border_edges + r.after.non_manifold_edges + r.after.misoriented_edges, 0);
    EXPECT_EQ(r.changed(), known != kRepaired.end() && !mesh.triangles.empty());
    if (!r.changed()) {
      EXPECT_TRUE(repaired.complex.vertices == mesh.vertices && repaired.complex.triangles == mesh.triangles);
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      ASSERT_LE((repaired.complex.vertices[repaired.vertex[i]] - mesh.vertices[i]).norm(), r.tolerance);
    ++files;
    solids += repaired.complex.solid;
  }
  EXPECT_EQ(files, 62);
  EXPECT_EQ(solids, 54);
}

// Its coordinates carry three decimals of a millimetre; its triangles without area are up to 0.83 um high.
TEST_F(RepairedMeshes, MayNeedAToleranceAsCoarseAsTheirCoordinates) {
  const RepairedMesh hole =
      repair_mesh(as_in_file(data / "meshes" / "factory_hole_round_8mm.obj"), {.relative_tolerance = 3e-5});
  EXPECT_TRUE(hole.complex.solid) << hole.report.reason;
  EXPECT_EQ(hole.report.after.self_intersections, 0);
  EXPECT_LT(hole.report.flipped_slivers.distance, 1e-6);
}

struct Fit {
  const char* pair = "";
  std::size_t pose = 0;
  double clearance = 0;  // the threshold is half as much again [m]
};

// A pair whose one part becomes a solid by repair, against the same part as sheets, as it is in the file.
TEST_F(RepairedMeshes, KeepTheSmallestGapOfAFit) {
  for (const Fit& fit : {Fit{"factory_m16_loose", 20, 9.7e-5}, Fit{"factory_gear_medium", 20, 1.3e-5}}) {
    SCOPED_TRACE(fit.pair);
    const AssemblyInput input = read_assembly_pair(data, fit.pair, 1e-3);
    EXPECT_TRUE(input.moving.complex.solid);
    const SimplicialComplex sheets = as_in_file(data / "meshes" / (input.moving.name + ".obj"));
    ASSERT_GT(report_mesh(sheets).self_intersections, 0);
    const LmdShape fixed = prepare(dilate(input.fixed.complex, 0));
    const LmdShape repaired = prepare(dilate(input.moving.complex, 0));
    const LmdShape raw = prepare(dilate(sheets, 0));
    const SE3& g = input.poses[fit.pose];
    const double tolerance = repair_mesh(sheets).report.tolerance;
    const LmdOptions options{.threshold = 1.5 * fit.clearance, .threads = 2};
    const double gap = smallest_gap(find_contacts({&repaired, g, 1}, {&fixed, {}, 0}, options));
    EXPECT_NEAR(gap, smallest_gap(find_contacts({&raw, g, 1}, {&fixed, {}, 0}, options)), tolerance);
    EXPECT_NEAR(gap, fit.clearance, 0.05 * fit.clearance) << "the recorded clearance";
  }
}

// Anywhere in the box of a part, and right before and behind its faces: bores, slots and threads have steel
// on one side and nothing on the other.
TEST_F(RepairedMeshes, RefuseAPointInTheirSteelAndTakeOneInTheirBores) {
  int solids = 0, inside = 0, outside = 0;
  for (const std::filesystem::path& path : shared_meshes(data)) {
    SCOPED_TRACE(path.filename().string());
    const AssemblyPart part = read_part(path, 1e-3);
    if (!part.complex.solid) continue;
    ++solids;
    const double size = part.report.box.diagonal(), near = 1e-4 * size;
    Model model;
    const BodyId steel =
        add(model, fixed_body("steel", add(model, prepare(dilate(part.complex, 1e-7 * size)))));
    const BodyId grain = add(model, RigidBody{.name = "grain",
                                              .shape = add(model, prepare(dilate(make_point(), 1e-7 * size))),
                                              .mass = 1,
                                              .inertia = Mat3::Identity()});
    const SimplicialComplex& surface = model.shapes[model.bodies[steel].shape]->complex;
    State state = rest_state(model);
    Random random(7);
    for (int k = 0; k < 60; ++k) {
      const auto& [a, b, c] = surface.triangles[std::size_t(random.index(int(surface.triangles.size())))];
      const Vec3 &x = surface.vertices[a], &y = surface.vertices[b], &z = surface.vertices[c];
      const Vec3 off = (k % 3 == 1 ? near : -near) * (y - x).cross(z - x).stableNormalized();
      const Vec3 share(random.uniform(), random.uniform(), random.uniform());
      const Vec3 p =
          k % 3 ? Vec3((x + y + z) / 3 + off)
                : Vec3(part.report.box.lo + share.cwiseProduct(part.report.box.hi - part.report.box.lo));
      const double turns = winding_number(surface, p);
      ASSERT_NEAR(turns, std::round(turns), 1e-6);
      pose(state, grain).p = p;
      const std::string said = message_of([&] { validate_start(model, state); });
      if (said.find("nearer") != std::string::npos) continue;
      if (turns > 0.5) {
        EXPECT_EQ(said, "start: body 1 (grain) lies inside the solid of body 0 (steel)") << p.transpose();
        ++inside;
      } else {
        EXPECT_EQ(said, "") << p.transpose();
        ++outside;
      }
    }
  }
  EXPECT_GE(solids, 30);
  EXPECT_GE(std::min(inside, outside), 15 * solids) << inside << " and " << outside << " starts";
}

}  // namespace
}  // namespace aussois
