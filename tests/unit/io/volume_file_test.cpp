// SPDX-License-Identifier: Apache-2.0
#include "io/volume_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

VolumeFile read_text(const std::string& name, const std::string& content, double scale = 1,
                     bool drop = false) {
  const auto folder = fresh_folder();
  return read_volume_mesh(write_bytes(folder / name, content), scale, drop);
}
std::string refusal(const std::string& name, const std::string& content) {
  return message_of<std::runtime_error>([&] { read_text(name, content); });
}

// Two tetrahedra of two materials, one face between them, and a triangle that is passed over.
const std::string kOld =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nof anything\n$EndComments\n"
    "$PhysicalNames\n3\n2 7 \"skin\"\n3 20 \"hard rubber\"\n3 10 \"steel\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n14 0 0 1\n5 1 1 1\n$EndNodes\n"
    "$Elements\n3\n1 2 2 7 1 1 2 3\n2 4 2 20 1 1 2 3 14\n3 4 2 10 1 2 3 14 5\n$EndElements\n";
const std::string kNew =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n1\n3 20 \"hard rubber\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 1 1 7 0\n1 0 0 0 1 1 1 1 20 1 1\n2 0 0 0 1 1 1 1 10 1 "
    "-1\n$EndEntities\n"
    "$Nodes\n2 5 1 14\n3 1 0 4\n1\n2\n3\n14\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 2 0 1\n5\n1 1 1\n$EndNodes\n"
    "$Elements\n3 3 1 3\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 14\n3 2 4 1\n3 2 3 14 5\n$EndElements\n";
const std::string kMedit =
    "MeshVersionFormatted 2 # a comment\nDimension\n3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 "
    "1 0\n"
    "Triangles\n1\n1 2 3 7\nRidges 1 4\nTetrahedra 2\n1 2 3 4 20\n2 3 4 5 10\nEnd\n";

TEST(ReadVolume, KnowsGmshAndMedit) {
  for (const auto& [name, text] : {std::pair("a.msh", kOld), {"b.MSH", kNew}, {"c.mesh", kMedit}}) {
    const VolumeFile file = read_text(name, text, 1e-3);
    EXPECT_EQ(file.mesh.points.size(), 5u) << name;
    EXPECT_EQ(file.mesh.points[1], Vec3(1e-3, 0, 0)) << name;
    ASSERT_EQ(file.mesh.tets.size(), 2u) << name;
    EXPECT_NEAR(volume(file.mesh, file.mesh.tets[0]), 1e-9 / 6, 1e-22) << name;
    EXPECT_NEAR(volume(file.mesh, file.mesh.tets[1]), 1e-9 / 3, 1e-22) << name;
    EXPECT_EQ(file.mesh.group_of, (std::vector<int>{1, 0})) << name;  // 10 comes before 20
    EXPECT_EQ(notes_of(file), "");
  }
  EXPECT_EQ(read_text("a.msh", kOld).groups, (std::vector<std::string>{"steel", "hard rubber"}));
  EXPECT_EQ(read_text("a.msh", kNew).groups, (std::vector<std::string>{"10", "hard rubber"}));
  EXPECT_EQ(read_text("a.mesh", kMedit).groups, (std::vector<std::string>{"10", "20"}));
}

TEST(ReadVolume, TurnsCellsThatAreAllInsideOut) {
  std::string text = kMedit;
  text.replace(text.find("1 2 3 4 20"), 10, "2 1 3 4 20");
  EXPECT_NE(refusal("a.mesh", text).find("tetrahedron 0 must have a volume above"), std::string::npos);
  text.replace(text.find("2 3 4 5 10"), 10, "3 2 4 5 10");
  const VolumeFile file = read_text("a.mesh", text);
  EXPECT_EQ(notes_of(file), "2 cells, all inside out, were turned");
  EXPECT_GT(volume(file.mesh, file.mesh.tets[0]), 0);
}

TEST(ReadVolume, ReadsHexahedra) {
  const VolumeFile file = read_text("a.mesh",
                                    "MeshVersionFormatted 1\nDimension 3\nVertices 8\n0 0 0 0\n1 0 0 0\n1 1 "
                                    "0 0\n0 1 0 0\n0 0 2 0\n1 0 2 0\n1 1 2 0\n"
                                    "0 1 2 0\nHexahedra 1\n1 2 3 4 5 6 7 8 3\n");
  ASSERT_EQ(file.mesh.hexes.size(), 1u);
  EXPECT_NEAR(volume(file.mesh, file.mesh.hexes[0]), 2, 1e-14);
}

TEST(ReadVolume, RefusesOrDropsPointsInNoCell) {
  std::string text = kMedit;
  text.replace(text.find("Vertices\n5\n"), 11, "Vertices\n6\n");
  text.insert(text.find("Triangles"), "9 9 9 0\n");
  expect_names(refusal("a.mesh", text), "1 of its points are in no cell; they may be dropped");
  const VolumeFile file = read_text("a.mesh", text, 1, true);
  EXPECT_EQ(file.mesh.points.size(), 5u);
  EXPECT_EQ(notes_of(file), "1 points in no cell were dropped");
}

TEST(ReadVolume, NamesWhatIsWrongAndWhere) {
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  expect_names(refusal("a.vtk", "x"), "extension '.vtk' must be .msh or .mesh");
  expect_names(refusal("a.msh", "hello"), "a.msh:1: 'hello' must begin a section");
  expect_names(refusal("a.msh", "$Nodes\n"), "must follow $MeshFormat");
  expect_names(refusal("a.msh", changed(kOld, "2.2 0 8", "3.0 0 8")),
               "a.msh:2: version '3.0' must be 2.2 or 4.1");
  expect_names(refusal("a.msh", changed(kOld, "2.2 0 8", "2.2 1 8")), "binary files of Gmsh are not read");
  expect_names(refusal("a.msh", changed(kOld, "5 1 1 1\n$EndNodes", "5 1 1 nan\n$EndNodes")),
               "a.msh:19: z = nan");
  expect_names(refusal("a.msh", changed(kOld, "5 1 1 1", "2 1 1 1")), "point 2 must be given once");
  expect_names(refusal("a.msh", changed(kOld, "2 4 2 20 1 1 2 3 14", "2 11 2 20 1 1 2 3 14")),
               "element type 11 is not read");
  expect_names(refusal("a.msh", changed(kOld, "2 3 14 5\n", "2 3 14 6\n")),
               "corner = 6 must be one of the points");
  expect_names(refusal("a.msh", changed(kOld, "$EndElements\n", "")), "must be $EndElements");
  expect_names(refusal("a.msh", changed(kOld, "$EndComments\n", "")), "file ends within section Comments");
  expect_names(refusal("a.msh", changed(kNew, "3 1 0 4", "3 1 1 4")), "parametric nodes are not read");
  expect_names(refusal("a.mesh", "Vertices 1"), "must be MeshVersionFormatted");
  expect_names(refusal("a.mesh", changed(kMedit, "\n3\n", "\n2\n")), "dimension = 2 must be 3");
  expect_names(refusal("a.mesh", "MeshVersionFormatted 2\nDimension 3\nEnd"),
               "has neither tetrahedra nor hexahedra");
  expect_names(refusal("a.mesh", changed(kMedit, "Tetrahedra 2", "Tetrahedra 3")), "corner");
  expect_names(message_of([] { read_text("a.mesh", kMedit, 0); }), "scale = 0 must");
}

}  // namespace
}  // namespace aussois
