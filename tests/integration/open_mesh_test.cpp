// SPDX-License-Identifier: Apache-2.0
// An open mesh where a solid is asked for is refused at the door, with counts; as a part it becomes sheets.
#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "io/mesh_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const std::filesystem::path kPeg = std::filesystem::path(AUSSOIS_SOURCE_DIR) / "examples/data/peg.obj";

MeshFile open_peg() {  // without the last of its triangles: three border edges
  MeshFile mesh = read_mesh(kPeg, 1e-3);
  mesh.triangles.pop_back();
  return mesh;
}

TEST(OpenMesh, IsRefusedWhereASolidIsAskedFor) {
  const MeshFile mesh = open_peg();
  const std::string message =
      message_of<std::invalid_argument>([&] { make_complex(mesh.vertices, mesh.triangles, {}, true); });
  EXPECT_NE(message.find("solid"), std::string::npos) << message;
  EXPECT_NE(message.find("3 "), std::string::npos) << message << ": the number of border edges";
}

TEST(OpenMesh, HasNoMassProperties) {
  const MeshFile mesh = open_peg();
  const SimplicialComplex sheets = make_complex(mesh.vertices, mesh.triangles);
  const std::string message = message_of<std::invalid_argument>([&] { mass_properties(sheets, 7850); });
  EXPECT_NE(message.find("closed"), std::string::npos) << message;
}

TEST(OpenMesh, BecomesAPartOfSheetsWithTheMassOfItsHull) {
  const std::filesystem::path folder = fresh_folder();
  write_obj(folder / "open.obj", open_peg(), 1e-3);
  const AssemblyPart whole = read_part(kPeg, 1e-3), open = read_part(folder / "open.obj", 1e-3);
  EXPECT_TRUE(whole.complex.solid);
  EXPECT_FALSE(open.complex.solid);
  ASSERT_EQ(open.notes.size(), 1U);
  EXPECT_NE(open.notes[0].find("3 border edges"), std::string::npos) << open.notes[0];
  const PartMass solid = part_mass(whole, 0, 7850, 0), hull = part_mass(open, 0, 7850, 0);
  EXPECT_EQ(solid.source, "solid");
  EXPECT_EQ(hull.source, "convex hull");
  EXPECT_NEAR(hull.properties.mass, solid.properties.mass, 1e-12 * solid.properties.mass);  // convex anyway
  // By hand: 10 x 10 x 24.5 mm and the chamfer, a frustum of height 0.5 mm between squares of 9 and 10 mm.
  EXPECT_NEAR(solid.properties.volume, 1e-9 * (10 * 10 * 24.5 + 0.5 / 3 * (81 + 100 + 90)), 1e-18);
}

}  // namespace
}  // namespace aussois
