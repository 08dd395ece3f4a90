// SPDX-License-Identifier: Apache-2.0
#include "io/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/check.hpp"
#include "geometry/mesh_report.hpp"
#include "geometry/number_text.hpp"
#include "io/atomic_file.hpp"
#include "io/mesh_formats.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// Vertices are counted by int: 4 GiB cannot hold more than 2^31 of them in any of the formats.
constexpr std::uintmax_t kLargestFile = std::uintmax_t(1) << 32;

// Curved surfaces become triangles elsewhere: gmsh reads these (doc/howto/import_a_cad_mesh.md).
std::string how_to_convert(const std::filesystem::path& path, const std::string& extension) {
  for (const char* cad : {".stp", ".step", ".igs", ".iges", ".brep"})
    if (extension == cad)
      return "; make triangles of it first: gmsh -2 " + path.filename().string() + " -format stl -bin -o " +
             path.stem().string() + ".stl";
  return {};
}

MeshFile read_by_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  using Reader = MeshFile (*)(const std::filesystem::path&, std::string_view);
  const Reader reader = extension == ".obj"   ? read_obj
                        : extension == ".stl" ? read_stl
                        : extension == ".ply" ? read_ply
                        : extension == ".off" ? read_off
                                              : nullptr;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kLargestFile)
    throw std::runtime_error(path.string() + ": size = " + std::to_string(size) + " bytes must be at most " +
                             std::to_string(kLargestFile));
  const std::string bytes =
      read_file(path);  // before the extension, so that a missing file is called missing
  if (!reader)
    throw std::runtime_error(path.string() + ": extension '" + extension +
                             "' must be .obj, .stl, .ply or .off" + how_to_convert(path, extension));
  return reader(path, bytes);
}

// Gives each vertex i the number new_index[i] (-1: it goes away), which no simplex may then name.
void renumber(MeshFile& mesh, const std::vector<int>& new_index) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (new_index[i] == int(kept.size())) kept.push_back(mesh.vertices[i]);
  mesh.vertices = std::move(kept);
  for (auto& triangle : mesh.triangles)
    for (int& vertex : triangle) vertex = new_index[vertex];
  for (auto& wire : mesh.wires)
    for (int& vertex : wire) vertex = new_index[vertex];
  for (int& point : mesh.points) point = new_index[point];
}

void drop_collapsed(MeshFile& mesh) {
  mesh.notes.collapsed_triangles += int(std::erase_if(
      mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }));
  mesh.notes.collapsed_wires += int(std::erase_if(mesh.wires, [](const auto& w) { return w[0] == w[1]; }));
}

// A vertex that triangles or wires name is part of them already; the others are points if the file says so,
// or if it holds nothing but vertices. OBJ, PLY and OFF keep vertices that nothing names: they are no part of
// the shape.
void settle_points(MeshFile& mesh) {
  const std::size_t n = mesh.vertices.size();
  const bool only_vertices = mesh.triangles.empty() && mesh.wires.empty() && mesh.points.empty() &&
                             mesh.notes.collapsed_triangles + mesh.notes.collapsed_wires == 0;
  std::vector<bool> in_simplex(n), is_point(n, only_vertices);
  for (const auto& triangle : mesh.triangles)
    for (const int vertex : triangle) in_simplex[vertex] = true;
  for (const auto& wire : mesh.wires)
    for (const int vertex : wire) in_simplex[vertex] = true;
  for (const int point : mesh.points) is_point[point] = true;

  mesh.points.clear();
  std::vector<int> new_index(n, -1);
  int kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!in_simplex[i] && !is_point[i]) continue;
    new_index[i] = kept++;
    if (!in_simplex[i]) mesh.points.push_back(int(i));
  }
  mesh.notes.unused_vertices += int(n) - kept;
  renumber(mesh, new_index);
}

void rescale(MeshFile& mesh, double scale, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] *= scale;
    if (!mesh.vertices[i].allFinite())
      throw std::runtime_error(path.string() + ": vertex " + std::to_string(i) +
                               " times scale must be finite");
  }
}

}  // namespace

void add_polygon(MeshFile& mesh, std::span<const int> corners) {
  mesh.notes.fanned_polygons += corners.size() > 3;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    mesh.triangles.push_back({corners[0], corners[k], corners[k + 1]});
}

void weld_mesh_file(MeshFile& mesh) {
  const std::size_t n = mesh.vertices.size();
  const std::vector<int> first = first_at_same_place(mesh.vertices);
  std::vector<int> new_index(n);
  int kept = 0;
  for (std::size_t i = 0; i < n; ++i) new_index[i] = first[i] == int(i) ? kept++ : new_index[first[i]];
  mesh.notes.welded_vertices += int(n) - kept;
  renumber(mesh, new_index);
  drop_collapsed(mesh);
  settle_points(mesh);
}

MeshFile read_mesh(const std::filesystem::path& path, double scale) {
  require_field(std::isfinite(scale) && scale > 0, "scale", scale, "be finite and > 0");
  MeshFile mesh = read_by_extension(path);
  drop_collapsed(mesh);
  settle_points(mesh);
  if (mesh.vertices.empty()) throw std::runtime_error(path.string() + ": has no triangle, wire or point");
  rescale(mesh, scale, path);
  return mesh;
}

std::string to_string(const MeshFileNotes& notes) {
  std::string text;
  const auto say = [&](int count, const char* one, const char* many) {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted_noun(count, one, many);
  };
  say(notes.fanned_polygons, "polygon cut into a fan", "polygons cut into fans");
  say(notes.welded_vertices, "vertex welded", "vertices welded");
  say(notes.collapsed_triangles, "collapsed triangle dropped", "collapsed triangles dropped");
  say(notes.collapsed_wires, "collapsed wire dropped", "collapsed wires dropped");
  say(notes.unused_vertices, "unused vertex dropped", "unused vertices dropped");
  return text;
}

void write_obj(const std::filesystem::path& path, const MeshFile& mesh, double scale) {
  require_field(std::isfinite(scale) && scale > 0, "scale", scale, "be finite and > 0");
  std::string text;
  for (const Vec3& x : mesh.vertices) {
    text += 'v';
    for (int k = 0; k < 3; ++k) append_number(text += ' ', x[k] / scale);
    text += '\n';
  }
  const auto append_indices = [&](const char* keyword, std::span<const int> indices) {
    text += keyword;
    for (const int index : indices) text += ' ' + std::to_string(index + 1);
    text += '\n';
  };
  for (const auto& triangle : mesh.triangles) append_indices("f", triangle);
  for (const auto& wire : mesh.wires) append_indices("l", wire);
  for (const int point : mesh.points) append_indices("p", std::span(&point, 1));
  write_whole_file(path, text);
}

}  // namespace aussois
