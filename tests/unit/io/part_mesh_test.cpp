// SPDX-License-Identifier: Apache-2.0
#include "io/part_mesh.hpp"

#include <algorithm>
#include <vector>

#include "geometry/primitives.hpp"
#include "io/mesh_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// A box of 10 mm with its vertices given twice and a corner cut open: to be welded, and no solid.
void write_open_box(const std::filesystem::path& path) {
  const SimplicialComplex box = make_box(0.01, 0.02, 0.03);
  MeshFile mesh;
  for (std::size_t t = 0; t + 1 < box.triangles.size(); ++t) {
    const int first = int(mesh.vertices.size());
    for (const int v : box.triangles[t]) mesh.vertices.push_back(box.vertices[v]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  write_obj(path, mesh, 1e-3);
}

std::string difference(const PartMesh& a, const PartMesh& b) {
  const SimplicialComplex &p = a.complex, &q = b.complex;
  if (!std::ranges::equal(p.vertices, q.vertices)) return "vertices";
  if (p.edges != q.edges) return "edges";
  if (p.triangles != q.triangles) return "triangles";
  if (p.triangle_edges != q.triangle_edges) return "triangle_edges";
  if (p.edge_triangles.items != q.edge_triangles.items) return "edge_triangles";
  if (p.vertex_edges.items != q.vertex_edges.items) return "vertex_edges";
  if (p.vertex_triangles.items != q.vertex_triangles.items) return "vertex_triangles";
  if (p.solid != q.solid) return "solid";
  if (to_string(a.report) != to_string(b.report)) return "report";
  return a.notes == b.notes ? "" : "notes";
}

TEST(PartMesh, TellsHowItsFileWasChangedAndWhyItIsNoSolid) {
  const auto path = fresh_folder() / "box.obj";
  write_open_box(path);
  const PartMesh mesh = read_part_mesh(path, 1e-3);
  EXPECT_EQ(mesh.complex.vertices.size(), 8U);
  EXPECT_FALSE(mesh.complex.solid);
  ASSERT_EQ(mesh.notes.size(), 2U);
  EXPECT_NE(mesh.notes[0].find("welded"), std::string::npos) << mesh.notes[0];
  EXPECT_NE(mesh.notes[1].find("not a solid"), std::string::npos) << mesh.notes[1];
}

TEST(CachedPartMesh, IsReadOnceThenLoadedWithTheSameBits) {
  const auto folder = fresh_folder(), path = folder / "box.obj", cache = folder / "kept";
  write_open_box(path);
  const CachedPartMesh first = read_part_mesh_cached(path, 1e-3, {}, cache),
                       second = read_part_mesh_cached(path, 1e-3, {}, cache);
  EXPECT_TRUE(!first.loaded && first.kept && first.warning.empty()) << first.warning;
  EXPECT_TRUE(second.loaded && second.kept && second.warning.empty()) << second.warning;
  EXPECT_EQ(difference(first.mesh, read_part_mesh(path, 1e-3)), "");
  EXPECT_EQ(difference(second.mesh, first.mesh), "");
  std::filesystem::copy(path, folder / "copy.obj");  // the name does not matter, the content does
  EXPECT_TRUE(read_part_mesh_cached(folder / "copy.obj", 1e-3, {}, cache).loaded);
  EXPECT_FALSE(read_part_mesh_cached(path, 1, {}, cache).loaded);
  EXPECT_FALSE(read_part_mesh_cached(path, 1e-3, {.relative_tolerance = 1e-5}, cache).loaded);
  write_obj(path, {.vertices = {Vec3::Zero()}, .points = {0}}, 1);
  EXPECT_EQ(read_part_mesh_cached(path, 1e-3, {}, cache).mesh.complex.vertices.size(), 1U);
}

TEST(CachedPartMesh, IsReadAgainWhereAFileCannotBeUsed) {
  const auto folder = fresh_folder(), path = folder / "box.obj", cache = folder / "kept";
  write_open_box(path);
  const CachedPartMesh first = read_part_mesh_cached(path, 1e-3, {}, cache);
  std::string bytes = content_of(first.file);
  bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 1);
  std::filesystem::remove(first.file);
  write_bytes(first.file, bytes);
  const CachedPartMesh again = read_part_mesh_cached(path, 1e-3, {}, cache);
  EXPECT_TRUE(!again.loaded && again.kept);
  EXPECT_NE(again.warning.find("damaged: its checksum does not fit; prepared again"), std::string::npos)
      << again.warning;
  EXPECT_EQ(difference(again.mesh, first.mesh), "");
  EXPECT_TRUE(read_part_mesh_cached(path, 1e-3, {}, cache).loaded);
}

TEST(CachedPartMesh, RefusesAMeshFileAsWithoutACache) {
  const auto folder = fresh_folder(), path = folder / "bad.obj";
  write_bytes(path, "v 0 0 x\n");
  const std::string plain = message_of<std::runtime_error>([&] { read_part_mesh(path, 1); });
  EXPECT_NE(plain.find("bad.obj:1"), std::string::npos) << plain;
  EXPECT_EQ(message_of<std::runtime_error>([&] { read_part_mesh_cached(path, 1, {}, folder / "kept"); }),
            plain);
  EXPECT_FALSE(std::filesystem::exists(folder / "kept"));
}

}  // namespace
}  // namespace aussois
