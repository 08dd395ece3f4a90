// SPDX-License-Identifier: Apache-2.0
#include "geometry/simplicial_complex.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "geometry/check.hpp"

namespace aussois {
namespace {

// Throws unless each of the `simplices` has distinct vertices that exist.
template <std::size_t N>
void check_simplices(const char* kind, std::span<const std::array<int, N>> simplices,
                     std::size_t vertex_count) {
  for (std::size_t i = 0; i < simplices.size(); ++i) {
    for (std::size_t k = 0; k < N; ++k) {
      const int vertex = simplices[i][k];
      if (vertex >= 0 && std::size_t(vertex) < vertex_count) continue;
      std::ostringstream text;
      text << kind << " " << i << ": vertex index = " << vertex << " must lie in [0, " << vertex_count << ")";
      throw std::invalid_argument(text.str());
    }
    for (std::size_t k = 0; k < N; ++k) {
      require(
          simplices[i][k] != simplices[i][(k + 1) % N],
          std::string(kind) + " " + std::to_string(i) + " repeats vertex " + std::to_string(simplices[i][k]));
    }
  }
}

void check_vertices(std::span<const Vec3> vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i].allFinite()) continue;
    std::ostringstream text;
    text << "vertex " << i << " = ("
         << vertices[i].transpose().format(Eigen::IOFormat(Eigen::StreamPrecision, Eigen::DontAlignCols))
         << ") must be finite";
    throw std::invalid_argument(text.str());
  }
}

// Row r of the result lists, in ascending order, the items whose corners contain r.
template <std::size_t N>
Incidence incidence(std::size_t row_count, std::span<const std::array<int, N>> corners) {
  std::vector<int> begin(row_count + 1, 0);
  for (const auto& item : corners)
    for (const int row : item) ++begin[std::size_t(row) + 1];
  for (std::size_t r = 0; r < row_count; ++r) begin[r + 1] += begin[r];
  std::vector<int> items(corners.size() * N), next = begin;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (const int row : corners[i]) items[next[row]++] = int(i);
  return {std::move(begin), std::move(items)};
}

struct HalfEdge {
  std::array<int, 2> ends{};  // ascending
  int triangle = -1;          // -1: a wire
  int side = 0;
  auto operator<=>(const HalfEdge&) const = default;  // NOLINT(modernize-use-nullptr): false alarm
};

std::vector<HalfEdge> sorted_half_edges(std::span<const std::array<int, 3>> triangles,
                                        std::span<const std::array<int, 2>> wires) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(3 * triangles.size() + wires.size());
  const auto add = [&](int a, int b, int triangle, int side) {
    half_edges.push_back({{std::min(a, b), std::max(a, b)}, triangle, side});
  };
  for (const auto& [a, b] : wires) add(a, b, -1, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) add(triangles[t][k], triangles[t][(k + 1) % 3], int(t), int(k));
  std::sort(half_edges.begin(), half_edges.end());
  return half_edges;
}

// Edges without exactly two triangles of opposite direction.
int count_open_or_twisted_edges(const SimplicialComplex& complex) {
  int count = 0;
  for (int e = 0; e < int(complex.edges.size()); ++e) {
    const std::span<const int> around = complex.edge_triangles[e];
    count += around.size() != 2 || runs_upwards(complex, around[0], e) == runs_upwards(complex, around[1], e);
  }
  return count;
}

void check_solid(const SimplicialComplex& complex) {
  require(!complex.triangles.empty(), "a solid must have triangles, this complex has none");
  const int bad = count_open_or_twisted_edges(complex);
  require(bad == 0, "a solid must be closed and oriented: " + std::to_string(bad) + " of " +
                        std::to_string(complex.edges.size()) +
                        " edges lack two triangles that run through them in opposite directions");
  const double volume = signed_volume(complex);
  require_field(volume > 0, "enclosed volume [m^3]", volume, "be > 0 (do the triangles face inwards?)");
}

}  // namespace

SimplicialComplex make_complex(SharedArray<Vec3> vertices, SharedArray<std::array<int, 3>> triangles,
                               const SharedArray<std::array<int, 2>>& wires, bool solid) {
  check_vertices(vertices);
  check_simplices<3>("triangle", triangles, vertices.size());
  check_simplices<2>("wire", wires, vertices.size());

  SimplicialComplex complex;
  complex.vertices = std::move(vertices);
  complex.triangles = std::move(triangles);
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 3>> triangle_edges(complex.triangles.size());
  std::vector<int> begin = {0}, around;  // triangles around edges
  for (const HalfEdge& half : sorted_half_edges(complex.triangles, wires)) {
    if (edges.empty() || edges.back() != half.ends) {
      edges.push_back(half.ends);
      begin.push_back(begin.back());
    }
    if (half.triangle < 0) continue;
    triangle_edges[half.triangle][half.side] = int(edges.size()) - 1;
    around.push_back(half.triangle);
    ++begin.back();
  }
  complex.edges = std::move(edges);
  complex.triangle_edges = std::move(triangle_edges);
  complex.edge_triangles = {std::move(begin), std::move(around)};
  complex.vertex_edges = incidence<2>(complex.vertices.size(), complex.edges);
  complex.vertex_triangles = incidence<3>(complex.vertices.size(), complex.triangles);
  if (solid) check_solid(complex);
  complex.solid = solid;
  return complex;
}

bool runs_upwards(const SimplicialComplex& complex, int t, int e) {
  const auto& sides = complex.triangle_edges[t];
  const auto side = std::size_t(std::find(sides.begin(), sides.end(), e) - sides.begin());
  return complex.triangles[t][side] == complex.edges[e][0];
}

bool is_closed_oriented(const SimplicialComplex& complex) {
  return !complex.triangles.empty() && count_open_or_twisted_edges(complex) == 0;
}

double signed_volume(const SimplicialComplex& complex) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : complex.triangles) {
    const Vec3& origin = complex.vertices[0];  // near the part, so that a far frame costs no digits
    const Vec3 to_a = complex.vertices[a] - origin;
    const Vec3 to_b = complex.vertices[b] - origin;
    const Vec3 to_c = complex.vertices[c] - origin;
    six_volumes += to_a.dot(to_b.cross(to_c));
  }
  return six_volumes / 6;
}

double radius_about(const SimplicialComplex& complex, const Vec3& centre) {
  double radius = 0;
  for (const Vec3& x : complex.vertices) radius = std::max(radius, (x - centre).norm());
  return radius;
}

Box bounding_box(const SimplicialComplex& complex) {
  Box box;
  for (const Vec3& x : complex.vertices) {
    box.lo = box.lo.cwiseMin(x);
    box.hi = box.hi.cwiseMax(x);
  }
  return box;
}

SimplicialComplex transformed_complex(const SimplicialComplex& complex, const SE3& g, double scale) {
  require_field(scale > 0 && std::isfinite(scale), "scale", scale, "be finite and > 0");
  std::vector<Vec3> vertices = complex.vertices.to_vector();
  for (Vec3& x : vertices) x = g * Vec3(scale * x);
  SimplicialComplex result = complex;
  result.vertices = std::move(vertices);
  return result;
}

}  // namespace aussois
