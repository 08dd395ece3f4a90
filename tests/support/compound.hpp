// SPDX-License-Identifier: Apache-2.0
// Complexes made of others.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// All triangles of the parts, whose vertices stay apart.
inline SimplicialComplex merged(const std::vector<SimplicialComplex>& parts, bool solid = false) {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (const SimplicialComplex& part : parts) {
    const int n = int(vertices.size());
    vertices.insert(vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) triangles.push_back({n + a, n + b, n + c});
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, solid);
}

inline SimplicialComplex inside_out(const SimplicialComplex& complex) {
  std::vector<std::array<int, 3>> triangles = complex.triangles.to_vector();
  for (auto& t : triangles) std::swap(t[1], t[2]);
  return make_complex(complex.vertices, std::move(triangles));
}

inline SimplicialComplex moved(const SimplicialComplex& complex, double x, double y, double z) {
  return transformed_complex(complex, translation(x, y, z));
}

/// The solid between two closed surfaces.
inline SimplicialComplex hollow(const SimplicialComplex& outer, const SimplicialComplex& inner) {
  return merged({outer, inside_out(inner)}, true);
}

}  // namespace aussois
