// SPDX-License-Identifier: Apache-2.0
#include "geometry/coarse_surface.hpp"

#include <cmath>
#include <meshoptimizer.h>

#include "geometry/check.hpp"
#include "geometry/self_intersections.hpp"

namespace aussois {
namespace {

bool encloses_a_volume(const SimplicialComplex& complex) {
  return is_closed_oriented(complex) && signed_volume(complex) > 0 && self_intersections(complex, 1).empty();
}

// The vertices that triangles use, in their order, and the triangles over them.
SimplicialComplex used_part(const SimplicialComplex& complex, const std::vector<unsigned>& corners) {
  std::vector<int> place(complex.vertices.size(), -1);
  for (const unsigned v : corners) place[v] = 0;
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < place.size(); ++v)
    if (place[v] == 0) place[v] = int(vertices.size()), vertices.push_back(complex.vertices[v]);
  std::vector<std::array<int, 3>> triangles;
  triangles.reserve(corners.size() / 3);
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
    triangles.push_back({place[corners[k]], place[corners[k + 1]], place[corners[k + 2]]});
  return make_complex(std::move(vertices), std::move(triangles));
}

}  // namespace

bool is_surface(const SimplicialComplex& complex) {
  for (std::size_t e = 0; e < complex.edges.size(); ++e)
    if (complex.edge_triangles[int(e)].empty()) return false;
  for (std::size_t v = 0; v < complex.vertices.size(); ++v)
    if (complex.vertex_triangles[int(v)].empty()) return false;
  return !complex.triangles.empty();
}

SimplicialComplex coarse_surface(const SimplicialComplex& complex, double distance) {
  require(is_surface(complex), "coarse_surface: the complex must consist of triangles alone");
  require_field(std::isfinite(distance) && distance > 0, "coarse_surface: distance", distance,
                "be finite and positive [m]");
  const Box box = bounding_box(complex);
  const Vec3 centre = (box.lo + box.hi) / 2;
  std::vector<float> x;  // about the centre: single precision is for choosing edges alone
  x.reserve(3 * complex.vertices.size());
  for (const Vec3& vertex : complex.vertices)
    for (const double coordinate : Vec3(vertex - centre)) x.push_back(float(coordinate));
  std::vector<unsigned> corners, out;
  corners.reserve(3 * complex.triangles.size());
  for (const auto& t : complex.triangles)
    for (const int v : t) corners.push_back(unsigned(v));
  out.resize(corners.size());
  constexpr std::size_t kVertexBytes = 3 * sizeof(float);
  const float scale = meshopt_simplifyScale(x.data(), complex.vertices.size(), kVertexBytes);
  const float error = float(distance) / scale;
  out.resize(meshopt_simplify(out.data(), corners.data(), corners.size(), x.data(), complex.vertices.size(),
                              kVertexBytes, 0, error));
  SimplicialComplex coarse = used_part(complex, out);
  coarse.solid = complex.solid && encloses_a_volume(coarse);
  return coarse;
}

}  // namespace aussois
