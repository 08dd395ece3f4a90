// SPDX-License-Identifier: Apache-2.0
#include "geometry/volume_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include <Eigen/LU>

#include "geometry/check.hpp"

namespace aussois {
namespace {

constexpr double kFlat = 1e-12;  // volume over the cube of the size of a cell that is none

// The faces of a hexahedron, counter-clockwise seen from outside.
constexpr std::array<std::array<int, 4>, 6> kHexFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<std::array<int, 3>, 4> kTetFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
constexpr std::array<std::array<double, 3>, 8> kHexCorners{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

// Three or four corners; the fourth of a triangle is -1.
using Face = std::array<int, 4>;
Face sorted(Face face) {
  std::ranges::sort(face);
  return face;
}

std::vector<Face> faces_of(const VolumeMesh& mesh, std::size_t cell) {
  std::vector<Face> out;
  if (cell < mesh.tets.size()) {
    const Tet& t = mesh.tets[cell];
    for (const auto& f : kTetFaces) out.push_back({t[f[0]], t[f[1]], t[f[2]], -1});
  } else {
    const Hex& h = mesh.hexes[cell - mesh.tets.size()];
    for (const auto& f : kHexFaces) out.push_back({h[f[0]], h[f[1]], h[f[2]], h[f[3]]});
  }
  return out;
}

std::vector<int> corners_of(const VolumeMesh& mesh, std::size_t cell) {
  if (cell < mesh.tets.size()) return {mesh.tets[cell].begin(), mesh.tets[cell].end()};
  const Hex& h = mesh.hexes[cell - mesh.tets.size()];
  return {h.begin(), h.end()};
}

std::string name_of(const VolumeMesh& mesh, std::size_t cell) {
  return cell < mesh.tets.size() ? "tetrahedron " + std::to_string(cell)
                                 : "hexahedron " + std::to_string(cell - mesh.tets.size());
}

// The cells on every face.
std::map<Face, std::vector<std::size_t>> cells_by_face(const VolumeMesh& mesh) {
  std::map<Face, std::vector<std::size_t>> out;
  for (std::size_t c = 0; c < mesh.cells(); ++c)
    for (const Face& face : faces_of(mesh, c)) out[sorted(face)].push_back(c);
  return out;
}

// The smallest volume of a cell, at its points by Gauss if it is a hexahedron, over its size cubed.
double fullness(const VolumeMesh& mesh, std::size_t cell) {
  const std::vector<int> corners = corners_of(mesh, cell);
  double size = 0;
  for (const int c : corners) size = std::max(size, (mesh.points[c] - mesh.points[corners[0]]).norm());
  double least = kInf;
  if (cell < mesh.tets.size())
    least = volume(mesh, mesh.tets[cell]);
  else
    for (const HexPoint& p : hex_points(mesh, mesh.hexes[cell - mesh.tets.size()]))
      least = std::min(least, p.volume);
  return least / (size * size * size);
}

void check_corners(const VolumeMesh& mesh) {
  const std::string range = "lie in [0, " + std::to_string(mesh.points.size()) + ")";
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    std::vector<int> corners = corners_of(mesh, c);
    const std::string who = "mesh: " + name_of(mesh, c) + ": corner";
    for (const int corner : corners)
      require_field(corner >= 0 && corner < std::ssize(mesh.points), who.c_str(), corner, range.c_str());
    std::ranges::sort(corners);
    const auto twice = std::ranges::adjacent_find(corners);
    require_field(twice == corners.end(), who.c_str(), twice == corners.end() ? 0 : *twice,
                  "stand for one corner only");
  }
}

// Says the first and the number of those that are wrong.
template <class IsWrong, class Name>
void require_none(std::size_t count, IsWrong is_wrong, Name name, const std::string& what) {
  std::size_t wrong = 0, first = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (is_wrong(i) && wrong++ == 0) first = i;
  require(wrong == 0, "mesh: " + (wrong ? name(first) : "") + " " + what + "; there are " +
                          std::to_string(wrong) + " such");
}

// Cells around a point hang together by faces that have the point.
void check_joined(const VolumeMesh& mesh, const std::map<Face, std::vector<std::size_t>>& by_face) {
  std::vector<std::vector<std::size_t>> around(mesh.points.size());
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> joined(mesh.points.size());
  for (std::size_t c = 0; c < mesh.cells(); ++c)
    for (const int corner : corners_of(mesh, c)) around[corner].push_back(c);
  for (const auto& [face, cells] : by_face)
    if (cells.size() == 2)
      for (const int corner : face)
        if (corner >= 0) joined[corner].emplace_back(cells[0], cells[1]);
  const auto parts = [&](std::size_t point) {
    const std::vector<std::size_t>& cells = around[point];
    std::vector<std::size_t> parent(cells.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::size_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    std::size_t count = cells.size();
    for (const auto& [a, b] : joined[point]) {
      const std::size_t i = root(std::size_t(std::ranges::lower_bound(cells, a) - cells.begin())),
                        j = root(std::size_t(std::ranges::lower_bound(cells, b) - cells.begin()));
      if (i != j) parent[i] = j, --count;
    }
    return count;
  };
  require_none(
      mesh.points.size(), [&](std::size_t p) { return parts(p) > 1; },
      [](std::size_t p) { return "point " + std::to_string(p); }, "joins parts that share no face there");
}

}  // namespace

double volume(const VolumeMesh& mesh, const Tet& t) {
  const Vec3& o = mesh.points[t[0]];
  return (mesh.points[t[1]] - o).cross(mesh.points[t[2]] - o).dot(mesh.points[t[3]] - o) / 6;
}

double volume(const VolumeMesh& mesh, const Hex& hex) {
  double sum = 0;
  for (const HexPoint& point : hex_points(mesh, hex)) sum += point.volume;
  return sum;
}

std::array<HexPoint, 8> hex_points(const VolumeMesh& mesh, const Hex& hex) {
  std::array<HexPoint, 8> out;
  const double g = 1 / std::sqrt(3.0);
  for (std::size_t k = 0; k < 8; ++k) {
    std::array<Vec3, 8> by{};  // derivatives of the shape functions on the cube
    Mat3 J = Mat3::Zero();     // of the place
    for (std::size_t a = 0; a < 8; ++a) {
      const auto& [x, y, z] = kHexCorners[a];
      const double X = 1 + g * x * kHexCorners[k][0], Y = 1 + g * y * kHexCorners[k][1],
                   Z = 1 + g * z * kHexCorners[k][2];
      by[a] = Vec3(x * Y * Z, y * X * Z, z * X * Y) / 8;
      J += mesh.points[hex[a]] * by[a].transpose();
    }
    const Mat3 inverse = J.inverse();
    out[k].volume = J.determinant();
    for (std::size_t a = 0; a < 8; ++a) out[k].gradient[a] = inverse.transpose() * by[a];
  }
  return out;
}

std::vector<std::array<int, 3>> boundary_triangles(const VolumeMesh& mesh) {
  const auto by_face = cells_by_face(mesh);
  std::vector<std::array<int, 3>> out;
  for (std::size_t c = 0; c < mesh.cells(); ++c)
    for (const Face& f : faces_of(mesh, c)) {
      if (by_face.at(sorted(f)).size() > 1) continue;
      out.push_back({f[0], f[1], f[2]});
      if (f[3] >= 0) out.push_back({f[0], f[2], f[3]});
    }
  return out;
}

void validate(const VolumeMesh& mesh) {
  require(mesh.cells() > 0, "mesh: has no cells");
  require_field(mesh.group_of.empty() || mesh.group_of.size() == mesh.cells(), "mesh: group_of.size()",
                mesh.group_of.size(),
                ("be 0 or " + std::to_string(mesh.cells()) + ", the number of cells").c_str());
  const auto point = [](std::size_t p) { return "point " + std::to_string(p); };
  const auto cell = [&](std::size_t c) { return name_of(mesh, c); };
  require_none(
      mesh.points.size(), [&](std::size_t p) { return !mesh.points[p].allFinite(); }, point,
      "must be finite [m]");
  check_corners(mesh);
  std::vector<char> used(mesh.points.size());
  for (std::size_t c = 0; c < mesh.cells(); ++c)
    for (const int corner : corners_of(mesh, c)) used[corner] = 1;
  require_none(
      used.size(), [&](std::size_t p) { return !used[p]; }, point, "is in no cell");
  require_none(
      mesh.cells(), [&](std::size_t c) { return !(fullness(mesh, c) > kFlat); }, cell,
      "must have a volume above 1e-12 of its size cubed, corners in the order of VolumeMesh");
  const auto by_face = cells_by_face(mesh);
  std::vector<char> crowded(mesh.cells());
  for (const auto& [face, cells] : by_face)
    if (cells.size() > 2) crowded[cells[0]] = 1;
  require_none(
      mesh.cells(), [&](std::size_t c) { return crowded[c] != 0; }, cell,
      "has a face that more than two cells have");
  check_joined(mesh, by_face);
}

int turn_outside_out(VolumeMesh& mesh) {
  for (std::size_t c = 0; c < mesh.cells(); ++c)
    if (!(fullness(mesh, c) < 0)) return 0;
  for (Tet& t : mesh.tets) std::swap(t[0], t[1]);
  for (Hex& h : mesh.hexes)
    for (std::size_t k = 0; k < 4; ++k) std::swap(h[k], h[k + 4]);
  return int(mesh.cells());
}

}  // namespace aussois
