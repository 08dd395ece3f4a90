// SPDX-License-Identifier: Apache-2.0
// What meshing and exporting do to a surface without changing its shape: other triangles, loose corners,
// T-junctions, triangles of no area.
#pragma once

#include <algorithm>

#include <Eigen/Geometry>

#include "geometry/mesh_report.hpp"
#include "tests/support/random.hpp"

namespace aussois {

struct LooseMesh {
  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
};

inline LooseMesh loose(const SimplicialComplex& complex) {
  return {complex.vertices.to_vector(), complex.triangles.to_vector()};
}

inline SimplicialComplex complex_of(const LooseMesh& mesh) {
  return make_complex(mesh.vertices, mesh.triangles);
}

inline const Vec3& corner(const LooseMesh& mesh, std::size_t triangle, std::size_t k) {
  return mesh.vertices[mesh.triangles[triangle][k % 3]];
}

inline double height_of(const LooseMesh& mesh, std::size_t triangle) {
  return triangle_height(corner(mesh, triangle, 0), corner(mesh, triangle, 1), corner(mesh, triangle, 2));
}

/// Every triangle with three vertices of its own, as in an STL file, each moved by up to `jiggle`.
inline LooseMesh soup_of(const LooseMesh& mesh, double jiggle, Random& random) {
  LooseMesh soup;
  for (const auto& triangle : mesh.triangles) {
    const int n = int(soup.vertices.size());
    soup.triangles.push_back({n, n + 1, n + 2});
    for (const int v : triangle)
      soup.vertices.push_back(mesh.vertices[v] + random.vector_of_length(0, jiggle));
  }
  return soup;
}

enum class Cut { conforming, t_junction, plugged };

/// Cuts a side of a random triangle, not thinner than `smallest`, at a random point: in all triangles at this
/// side, in that one alone, or in that one with a triangle of no area over the whole side.
inline void cut_a_side(LooseMesh& mesh, Cut kind, double smallest, double jiggle, Random& random) {
  const auto chosen = std::size_t(random.index(int(mesh.triangles.size())));
  const auto side = std::size_t(random.index(3));
  const int a = mesh.triangles[chosen][side], b = mesh.triangles[chosen][(side + 1) % 3];
  const Vec3 p = mesh.vertices[a], q = mesh.vertices[b];
  if (height_of(mesh, chosen) < smallest || (q - p).norm() < smallest) return;
  const int v = int(mesh.vertices.size());
  const Vec3 at = p + random.uniform(0.3, 0.7) * (q - p);
  mesh.vertices.push_back(at + jiggle * random.direction());
  const std::size_t n = mesh.triangles.size();
  for (std::size_t t = 0; t < n; ++t) {
    const std::array<int, 3> corners = mesh.triangles[t];
    const bool has_side = std::ranges::count(corners, a) + std::ranges::count(corners, b) == 2;
    if (t != chosen && (kind != Cut::conforming || !has_side)) continue;
    std::ranges::replace(mesh.triangles[t], b, v);
    mesh.triangles.push_back(corners);
    std::ranges::replace(mesh.triangles.back(), a, v);
  }
  if (kind == Cut::plugged) mesh.triangles.push_back({a, b, v});
}

/// Flips a random edge between two triangles of one plane whose quadrangle is convex.
inline void flip_a_flat_edge(LooseMesh& mesh, Random& random) {
  const SimplicialComplex complex = complex_of(mesh);
  const int e = random.index(int(complex.edges.size()));
  const auto around = complex.edge_triangles[e];
  if (around.size() != 2) return;
  const int a = complex.edges[e][0], b = complex.edges[e][1];
  const auto apex = [&](int t) {
    for (const int v : complex.triangles[t])
      if (v != a && v != b) return v;
    return -1;
  };
  const auto first = std::size_t(around[0]), second = std::size_t(around[1]);
  const int c = apex(around[0]), d = apex(around[1]);
  const auto normal = [&](const std::array<int, 3>& t) -> Vec3 {
    const Vec3& x = mesh.vertices[t[0]];
    return (mesh.vertices[t[1]] - x).cross(mesh.vertices[t[2]] - x);
  };
  const Vec3 n = normal(mesh.triangles[first]), m = normal(mesh.triangles[second]);
  if (n.normalized().dot(m.normalized()) < 1 - 1e-9) return;
  std::array<int, 3> left = mesh.triangles[first], right = left;
  std::ranges::replace(left, b, d);
  std::ranges::replace(right, a, d);
  if (normal(left).dot(n) < 0.05 * n.squaredNorm() || normal(right).dot(n) < 0.05 * n.squaredNorm()) return;
  if (c == d) return;
  mesh.triangles[first] = left;
  mesh.triangles[second] = right;
}

}  // namespace aussois
