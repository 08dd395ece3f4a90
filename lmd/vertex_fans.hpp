// SPDX-License-Identifier: Apache-2.0
// Finds the rounds of triangles and regions about the vertices of a closed, oriented surface.
#pragma once

#include <algorithm>
#include <vector>

#include "lmd/idealisation.hpp"

namespace aussois {

struct Corner {
  int triangle = -1, side = 0;  // the corner from which this side of the triangle starts
};

/// One round of triangles about a vertex, counter-clockwise, and the regions in it. A vertex where several
/// rounds touch has as many fans; they separate when eroded.
struct Fan {
  int vertex = 0;
  std::vector<int> regions{};
  std::vector<Corner> first{};  // the first triangle of each region; its side is the edge to the one before
  std::vector<Corner> round{};  // all triangles
};

inline int other_triangle(const SimplicialComplex& k, int edge, int t) {
  const auto both = k.edge_triangles[edge];
  return both[0] == t ? both[1] : both[0];
}

inline std::size_t corner_at(const SimplicialComplex& k, int t, int vertex) {
  const auto& v = k.triangles[t];
  return std::size_t(std::find(v.begin(), v.end(), vertex) - v.begin());
}

inline Vec3 centre_of(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[t];
  return (k.vertices[a] + k.vertices[b] + k.vertices[c]) / 3;
}

inline std::vector<Fan> find_fans(const SimplicialComplex& k, const Idealisation& ideal) {
  std::vector<Fan> fans;
  std::vector<std::array<char, 3>> seen(k.triangles.size(), {0, 0, 0});
  const auto region = [&](const Corner& c) { return ideal.triangle_region[c.triangle]; };
  for (int v = 0; v < int(k.vertices.size()); ++v)
    for (int t : k.vertex_triangles[v]) {
      std::size_t side = corner_at(k, t, v);
      std::vector<Corner> round;
      for (int at = t; !seen[at][side]; side = corner_at(k, at, v)) {
        seen[at][side] = 1;
        round.push_back({at, int(side)});
        at = other_triangle(k, k.triangle_edges[at][(side + 2) % 3], at);
      }
      if (round.empty()) continue;
      const std::size_t n = round.size();
      for (std::size_t i = 0; i < n; ++i)
        if (region(round[i]) != region(round[(i + n - 1) % n])) {
          std::rotate(round.begin(), round.begin() + long(i), round.end());
          break;
        }
      Fan fan{.vertex = v, .round = round};
      for (std::size_t i = 0; i < n; ++i)
        if (i == 0 || region(round[i]) != region(round[i - 1])) {
          fan.regions.push_back(region(round[i]));
          fan.first.push_back(round[i]);
        }
      fans.push_back(std::move(fan));
    }
  return fans;
}

}  // namespace aussois
