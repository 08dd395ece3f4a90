// SPDX-License-Identifier: Apache-2.0
#include "io/mesh_file.hpp"

#include <bit>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "geometry/mesh_report.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Triangles = std::vector<std::array<int, 3>>;
using Wires = std::vector<std::array<int, 2>>;

MeshFile read_text(const std::string& name, const std::string& content, double scale = 1) {
  const auto folder = fresh_folder();
  return read_mesh(write_bytes(folder / name, content), scale);
}

template <class T>
void append(std::string& bytes, T value, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

std::string binary_stl(const std::string& header, const SimplicialComplex& complex) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t(complex.triangles.size()));
  for (const auto& triangle : complex.triangles) {
    for (int k = 0; k < 3; ++k) append(bytes, std::nanf(""));  // the normal is not read
    for (const int v : triangle)
      for (int k = 0; k < 3; ++k) append(bytes, float(complex.vertices[v][k]));
    append(bytes, std::uint16_t(7));
  }
  return bytes;
}

std::string ply(const std::string& format, const SimplicialComplex& complex) {
  std::string text =
      "ply\nformat " + format + " 1.0\ncomment with a property in front, one behind and another element\n";
  text += "element vertex " + std::to_string(complex.vertices.size()) + "\n";
  text += "property float nx\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n";
  text += "element face " + std::to_string(complex.triangles.size()) + "\n";
  text += "property short flag\nproperty list uchar uint vertex_index\nproperty list int float uv\n";
  text += "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const auto order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  const bool ascii = format == "ascii";
  const auto put = [&](auto value) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%.17g ", double(value));
    if (ascii)
      text += digits;
    else
      append(text, value, order);
  };
  const auto end_row = [&] { text += ascii ? "\n" : ""; };
  for (const Vec3& x : complex.vertices) {
    put(std::nanf("")), put(x.x()), put(x.y()), put(x.z()), put(std::uint8_t(200));
    end_row();
  }
  for (const auto& [a, b, c] : complex.triangles) {
    put(std::int16_t(-3)), put(std::uint8_t(3)), put(std::uint32_t(a)), put(std::uint32_t(b)),
        put(std::uint32_t(c));
    put(std::int32_t(1)), put(0.5f);
    end_row();
  }
  put(std::int32_t(2)), put(std::int32_t(0));
  end_row();
  return text;
}

// --- OBJ
// -----------------------------------------------------------------------------------------------------------

TEST(ReadObj, KnowsEveryFormOfACorner) {
  const MeshFile mesh = read_text(
      "a.obj",
      "# a comment\nmtllib x.mtl\no part\nv 0 0 0\nv 1e-3 +0 0 # tail\r\nv 0 1 0 1.0\nv 0 0 1 .5 .5 .5\n"
      "vt 0 0\nvn 0 0 1\ns off\nf 1 2 3\nf 1/1 2/1 4/1\nf 1//1 2//1 3//1\nf 1/1/1 -3/1/1 -1/-1/-1\n"
      "f 2 \\\n 3 \\\n 4\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 3}, {0, 1, 2}, {0, 1, 3}, {1, 2, 3}}));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.vertices[1], Vec3(1e-3, 0, 0));
  EXPECT_EQ(to_string(mesh.notes), "");
}

TEST(ReadObj, CutsPolygonsIntoFans) {
  const MeshFile mesh =
      read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nf 1 2 3 4 5\nf 1 2 3\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 1, 2}}));
  EXPECT_EQ(mesh.notes.fanned_polygons, 1);
}

TEST(ReadObj, KeepsWiresAndPoints) {
  const MeshFile mesh =
      read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nl 1 2 3\nl 3 3\np 4 1\n");
  EXPECT_EQ(mesh.wires, (Wires{{0, 1}, {1, 2}}));
  EXPECT_EQ(mesh.points, std::vector<int>{3}) << "vertex 1 is part of a wire already";
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.notes.unused_vertices, 1) << "nothing names vertex 5";
  EXPECT_EQ(mesh.notes.collapsed_wires, 1);
  const SimplicialComplex complex = make_complex(mesh.vertices, mesh.triangles, mesh.wires);
  EXPECT_EQ(report_mesh(complex).isolated_vertices, 1);
}

TEST(ReadObj, TakesVerticesAloneAsPoints) {
  const MeshFile mesh = read_text("a.obj", "v 0 0 0\nv 1 0 0\n");
  EXPECT_EQ(mesh.points, (std::vector{0, 1}));
}

TEST(ReadObj, AllowsVerticesAfterTheFacesThatNameThem) {
  EXPECT_EQ(read_text("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles, (Triangles{{0, 1, 2}}));
}

TEST(ReadObj, DropsAndCountsCollapsedTriangles) {
  const MeshFile mesh = read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 2\nf 1 2 3 3 4\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.notes.collapsed_triangles, 2);
  EXPECT_EQ(to_string(mesh.notes), "1 polygon cut into a fan, 2 collapsed triangles dropped");
}

TEST(ReadObj, KeepsTrianglesWithoutAreaAndVerticesAtOnePlace) {
  const MeshFile mesh = read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 0\nf 1 2 3\nf 4 2 3\n");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u)
      << "an index is the word of the file; only STL, which has none, is welded";
}

TEST(ReadMesh, ScalesCoordinates) {
  const MeshFile mesh = read_text("a.OBJ", "v 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1e-3);
  EXPECT_EQ(mesh.vertices[0], Vec3(1e-3, 2e-3, 3e-3));
}

TEST(ReadMesh, RefusesAScaleThatIsNone) {
  const auto folder = fresh_folder();
  const auto path = write_bytes(folder / "a.obj", "v 1e300 0 0\n");
  for (const double scale : {0.0, -1.0, std::nan(""), kInf})
    EXPECT_THROW(read_mesh(path, scale), std::invalid_argument);
  EXPECT_EQ(message_of<std::runtime_error>([&] { read_mesh(path, 1e10); }),
            path.string() + ": vertex 0 times scale must be finite");
}

// --- STL
// -----------------------------------------------------------------------------------------------------------

TEST(ReadStl, WeldsBinaryTrianglesToTheSurfaceTheyCameFrom) {
  const SimplicialComplex torus = make_torus(2, 0.5, 24, 12);
  const MeshFile mesh = read_text("a.stl", binary_stl("binary", torus));
  EXPECT_EQ(mesh.triangles.size(), torus.triangles.size());
  EXPECT_EQ(mesh.vertices.size(), torus.vertices.size());
  EXPECT_EQ(mesh.notes.welded_vertices, int(3 * torus.triangles.size() - torus.vertices.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.vertices[mesh.triangles[t][k]],
                torus.vertices[torus.triangles[t][k]].cast<float>().cast<double>());
  EXPECT_TRUE(report_mesh(make_complex(mesh.vertices, mesh.triangles)).solid());
}

TEST(ReadStl, KnowsABinaryFileThatSaysSolid) {
  const SimplicialComplex box = make_box(1, 1, 1);
  EXPECT_EQ(read_text("a.stl", binary_stl("solid facet normal", box)).triangles.size(), 12u);
}

TEST(ReadStl, ReadsTextWithSeveralSolidsInDouble) {
  const std::string facet =
      "facet normal nan nan nan\nouter loop\nvertex 0.1 0 0\nvertex 1 0 0\nvertex 0 1e0 "
      "0\nendloop\nendfacet\n";
  const MeshFile mesh =
      read_text("a.stl", "solid one\n" + facet + "endsolid one\n\n  solid\n" + facet + "endsolid\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}}));
  EXPECT_EQ(mesh.vertices[0].x(), 0.1) << "not 0.1f";
}

TEST(Weld, MergesEqualPlacesOnly) {
  MeshFile mesh = read_text(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv -0 0 0\nv 1 1 1e-300\nf 1 2 3\nf 4 5 2\nf 1 4 2\nl 1 4\np 4\n");
  weld_mesh_file(mesh);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 3, 1}}));
  EXPECT_TRUE(mesh.wires.empty());
  EXPECT_TRUE(mesh.points.empty());
  EXPECT_EQ(to_string(mesh.notes), "1 vertex welded, 1 collapsed triangle dropped, 1 collapsed wire dropped");
}

// --- PLY, OFF
// --------------------------------------------------------------------------------------------------------

TEST(ReadPly, GivesTheSameInThreeEncodings) {
  const SimplicialComplex torus = make_torus(2, 0.5, 24, 12);
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const MeshFile mesh = read_text("a.ply", ply(format, torus));
    EXPECT_EQ(mesh.vertices, torus.vertices) << format;
    EXPECT_EQ(mesh.triangles, torus.triangles) << format;
    EXPECT_EQ(mesh.wires, (Wires{{2, 0}})) << format;
  }
}

TEST(ReadPly, TakesHeaderLinesOfAnySystem) {
  std::string text = ply("ascii", make_box(1, 2, 3));
  for (std::size_t i = text.find('\n'); i != text.npos; i = text.find('\n', i + 2)) text.insert(i, 1, '\r');
  EXPECT_EQ(read_text("a.ply", text).triangles.size(), 12u);
}

TEST(ReadOff, SkipsCommentsColoursAndNormals) {
  for (const char* keyword : {"OFF\n3 2 0", "OFF 3 2 0", "# c\nCOFF\n\n# d\n3 2 5\n"}) {
    const MeshFile mesh =
        read_text("a.off", std::string(keyword) +
                               "\n0 0 0 255 0 0 255\n1 0 0\n# e\n0 1 0\n3 0 1 2 0.5 0.5 0.5\n4 0 1 2 0\n");
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}})) << "the second of the fan collapses";
    EXPECT_EQ(mesh.notes.collapsed_triangles, 1);
  }
}

// --- writing
// -----------------------------------------------------------------------------------------------------------

TEST(WriteObj, ReadsBackAsTheSameBits) {
  Random random(7);
  MeshFile mesh;
  for (int i = 0; i < 300; ++i) {  // any finite doubles at all
    Vec3 x;
    for (int k = 0; k < 3; ++k) do
        x[k] = std::bit_cast<double>(random.bits());
      while (!std::isnormal(x[k]));
    mesh.vertices.push_back(x);
  }
  for (int i = 0; i + 2 < 200; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  for (int i = 200; i + 1 < 280; ++i) mesh.wires.push_back({i, i + 1});
  for (int i = 280; i < 300; ++i) mesh.points.push_back(i);
  const auto folder = fresh_folder();
  write_obj(folder / "a.obj", mesh, 1);
  const MeshFile back = read_mesh(folder / "a.obj", 1);
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.wires, mesh.wires);
  EXPECT_EQ(back.points, mesh.points);
}

TEST(WriteObj, LeavesNothingBehindButTheFile) {
  const auto folder = fresh_folder();
  MeshFile mesh;
  mesh.vertices = {Vec3(1e-3, 0, 0)};
  mesh.points = {0};
  write_bytes(folder / "a.obj", "old");
  write_obj(folder / "a.obj", mesh, 1e-3);
  EXPECT_EQ(content_of(folder / "a.obj"), "v 1 0 0\np 1\n");
  EXPECT_THROW(write_obj(folder / "missing" / "a.obj", mesh, 1), std::runtime_error);
  std::filesystem::create_directory(folder / "taken.obj");
  write_bytes(folder / "taken.obj/file", "x");
  EXPECT_THROW(write_obj(folder / "taken.obj", mesh, 1), std::runtime_error);
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++entries;
  EXPECT_EQ(entries, 2) << "a.obj and taken.obj, no temporary file";
}

// --- broken files
// --------------------------------------------------------------------------------------------------------

struct Broken {
  const char* file = "";
  const char* message = "";  // after the path
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) {
  return out << broken.file;
}

class BrokenMesh : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenMesh, EndsWithOneClearMessage) {
  const auto path = std::filesystem::path(AUSSOIS_SOURCE_DIR) / "tests/data/broken" / GetParam().file;
  EXPECT_EQ(message_of<std::runtime_error>([&] { read_mesh(path, 1); }), path.string() + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Files, BrokenMesh,
    ::testing::Values(
        Broken{"all_collapsed.obj", ": has no triangle, wire or point"},
        Broken{"binary.off", ":1: binary OFF is not read; convert it to text or PLY"},
        Broken{"comma_decimals.obj", ":1: x = '0,5' must be a number"},
        Broken{"comments_only.obj", ": has no triangle, wire or point"},
        Broken{"count_too_large.stl",
               ": byte 80: 1000 triangles announced need 50084 bytes, the file has 184"},
        Broken{"count_too_small.stl", ": byte 80: 1 triangle announced needs 134 bytes, the file has 184"},
        Broken{"cut_ascii.stl", ":6: file ends where 'vertex' must follow"},
        Broken{"element_without_property.ply", ":8: element 'ghost' has no property"},
        Broken{"empty.obj", ": is empty"}, Broken{"empty_ascii.stl", ": has no triangle, wire or point"},
        Broken{"extra_rows.off", ":7: more lines than the header announces"},
        Broken{"four_vertices_ascii.stl", ":7: 'vertex' must be 'endloop'"},
        Broken{"fraction_index.ply", ":14: vertex index = 1.5 must be an integer in [0, 3)"},
        Broken{"huge_count.off", ":2: number of vertices = 4000000000 must lie in [0, 2147483647]"},
        Broken{"huge_count.ply",
               ":4: element 'vertex' announces 4000000000 rows of at least 6 bytes, 26 bytes follow"},
        Broken{"huge_count_binary.ply",
               ":4: element 'vertex' announces 4000000000 rows of at least 12 bytes, 36 bytes follow"},
        Broken{"huge_face.off", ":6: corners = 4000000000 must be at most the 3 numbers that follow"},
        Broken{"huge_list_binary.ply",
               ": byte 216: face 0: length of list 'vertex_indices' = 4294967280 must be an integer in [0, "
               "12], the bytes that follow"},
        Broken{"index_out_of_range.obj", ":4: vertex index = 4 must lie in [1, 3] or [-3, -1]"},
        Broken{"index_out_of_range.off", ":6: vertex index = 3 must lie in [0, 3)"},
        Broken{"index_out_of_range.ply", ":14: vertex index = 3 must be an integer in [0, 3)"},
        Broken{"index_out_of_range_binary.ply",
               ": byte 214: face 0: vertex index = 7 must be an integer in [0, 3)"},
        Broken{"index_with_text.obj", ":4: texture index = 'x' must be an integer"},
        Broken{"index_zero.obj", ":4: vertex index = 0 must lie in [1, 3] or [-3, -1]"},
        Broken{"inf.obj", ":3: z = -inf must be finite"},
        Broken{"missing_rows.off", ":6: file ends where a face must follow"},
        Broken{"missing_rows.ply", ":15: file ends within a row of element 'face'"},
        Broken{"nan.obj", ":2: y = nan must be finite"}, Broken{"nan.off", ":4: y = nan must be finite"},
        Broken{"nan.ply", ":12: y = nan must be finite"},
        Broken{"nan.stl", ": byte 170: triangle 1, corner 2 must be finite"},
        Broken{"nan_ascii.stl", ":5: x = nan must be finite"},
        Broken{"nan_binary.ply", ": byte 193: vertex 1: y = nan must be finite"},
        Broken{"negative_count.off", ":2: number of faces = -1 must lie in [0, 2147483647]"},
        Broken{"negative_count.ply", ":4: number of rows = -3 must be >= 0"},
        Broken{"negative_index.ply", ":14: vertex index = -1 must be an integer in [0, 3)"},
        Broken{"negative_index_out_of_range.obj", ":4: vertex index = -4 must lie in [1, 3] or [-3, -1]"},
        Broken{"no_end_header.ply",
               ":10: '0' must be a complete line 'format', 'element', 'property' or 'end_header'"},
        Broken{"no_endsolid_ascii.stl", ":9: file ends where 'facet' or 'endsolid' must follow"},
        Broken{"no_keyword.off", ":1: '3' must be OFF, COFF, NOFF, CNOFF or STOFF"},
        Broken{"no_magic.ply", ":1: the first line must be 'ply'"},
        Broken{"no_z.ply", ":4: element 'vertex' must have a number property 'z'"},
        Broken{"not_a_mesh.stl", ":1: 'This' must be 'solid'"},
        Broken{"overflow.obj", ":2: x = '1e999' must fit a double, 1e-308 to 1e308"},
        Broken{"short_face.off", ":6: corners = 3 must be at most the 2 numbers that follow"},
        Broken{"triangle_strips.ply", ":8: triangle strips are not read; convert them to faces"},
        Broken{"truncated.stl", ": byte 80: 2 triangles announced need 184 bytes, the file has 164"},
        Broken{"truncated_binary.ply", ": byte 230: face 1: file ends within the row"},
        Broken{"truncated_header.stl",
               ": byte 37: file must have at least the 84 bytes of a binary STL header"},
        Broken{"truncated_named_solid.stl",
               ": byte 80: 2 triangles announced need 184 bytes, the file has 164"},
        Broken{"two_coordinates.obj", ":2: coordinates of the vertex = 2 must be at least 3"},
        Broken{"two_corners.obj", ":4: corners = 2 must be at least 3"},
        Broken{"two_vertices_ascii.stl", ":6: 'endloop' must be 'vertex'"},
        Broken{"cad.stp",
               ": extension '.stp' must be .obj, .stl, .ply or .off; make triangles of it first: gmsh -2 "
               "cad.stp -format stl -bin -o cad.stl"},
        Broken{"unknown_extension.xyz", ": extension '.xyz' must be .obj, .stl, .ply or .off"},
        Broken{"unknown_format.ply",
               ":2: format = 'ebcdic' must be ascii, binary_little_endian or binary_big_endian"},
        Broken{"unknown_keyword.obj",
               ":4: keyword 'curv' must be v, f, l, p or decoration (vt, vn, g, usemtl ...)"},
        Broken{"unknown_type.ply", ":5: type 'real' must be one of char, uchar, ..., double"},
        Broken{"word.ply", ":12: y = 'one' must be a number"},
        Broken{"word_ascii.stl", ":5: y = 'O' must be a number"},
        Broken{"word_for_number.obj", ":2: y = 'zero' must be a number"},
        Broken{"zero_triangles.stl", ": has no triangle, wire or point"},
        Broken{"does_not_exist.obj", ": no such file"}, Broken{"", ": is a directory, not a file"}),
    [](const auto& broken) {
      std::string name = broken.param.file;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name.empty() ? "folder" : name;
    });

TEST(BrokenMeshes, AreAllInTheTable) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(AUSSOIS_SOURCE_DIR "/tests/data/broken"))
    files += entry.path().extension() != ".csv";
  EXPECT_EQ(files, 62);
}

// Nothing but a message or a mesh may come out, whatever the bytes; a crash, a hang or a sanitizer would fail
// here.
TEST(ReadMesh, SurvivesFilesCutAnywhereAndChangedAnywhere) {
  const auto folder = fresh_folder();
  const SimplicialComplex box = make_box(1, 2, 3);
  MeshFile mesh;
  mesh.vertices = box.vertices.to_vector();
  mesh.triangles = box.triangles.to_vector();
  write_obj(folder / "whole.obj", mesh, 1);
  const std::string off = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";
  const std::pair<std::string, std::string> wholes[] = {{"a.obj", content_of(folder / "whole.obj")},
                                                        {"b.stl", binary_stl("binary", box)},
                                                        {"c.ply", ply("ascii", box)},
                                                        {"d.ply", ply("binary_little_endian", box)},
                                                        {"e.ply", ply("binary_big_endian", box)},
                                                        {"f.off", off}};
  Random random(11);
  SCOPED_TRACE("seed 11");
  for (const auto& [name, whole] : wholes) {
    int refused = 0, accepted = 0;
    for (int trial = 0; trial < 200; ++trial) {
      std::string bytes = whole;
      if (trial % 2) bytes.resize(1 + random.bits() % (bytes.size() - 1));
      for (int change = 0; change < trial % 5; ++change)
        bytes[random.bits() % bytes.size()] = char(random.bits() % 256);
      const auto path = write_bytes(folder / name, bytes);
      const bool bad =
          !message_of<std::runtime_error>([&] {
             const MeshFile read = read_mesh(path, 1);
             make_complex(read.vertices, read.triangles, read.wires);  // would throw std::invalid_argument
           }).empty();
      ++(bad ? refused : accepted);
    }
    EXPECT_GT(refused, 50) << name;
    EXPECT_GT(accepted, 19) << name;
  }
}

}  // namespace
}  // namespace aussois
