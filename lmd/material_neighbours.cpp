// SPDX-License-Identifier: Apache-2.0
#include "lmd/material_neighbours.hpp"

#include <algorithm>
#include <map>
#include <queue>

#include "geometry/check.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {
namespace {

// The vertices nearer than `reach` to one of them, by Dijkstra.
std::vector<int> near_along_edges(const SimplicialComplex& k, int from, double reach) {
  std::map<int, double> distance;
  using Reached = std::pair<double, int>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  open.emplace(0, from);
  while (!open.empty()) {
    const auto [so_far, vertex] = open.top();
    open.pop();
    if (!distance.emplace(vertex, so_far).second) continue;
    for (const int e : k.vertex_edges[vertex]) {
      const int other = k.edges[e][0] == vertex ? k.edges[e][1] : k.edges[e][0];
      const double there = so_far + (k.vertices[other] - k.vertices[vertex]).norm();
      if (there < reach && !distance.contains(other)) open.emplace(there, other);
    }
  }
  std::vector<int> out;
  for (const auto& [vertex, unused] : distance) out.push_back(vertex);
  return out;
}

}  // namespace

std::shared_ptr<const MaterialNeighbours> material_neighbours(const SimplicialComplex& complex,
                                                              double reach) {
  require_field(reach > 0 && std::isfinite(reach), "material_neighbours: reach", reach,
                "be positive and finite [m]");
  auto out = std::make_shared<MaterialNeighbours>();
  for (int v = 0; v < int(complex.vertices.size()); ++v) {
    const std::vector<int> near = near_along_edges(complex, v, reach);
    out->vertex.insert(out->vertex.end(), near.begin(), near.end());
    out->begin.push_back(int(out->vertex.size()));
  }
  return out;
}

bool meet(const MaterialNeighbours& of, std::span<const int> a, std::span<const int> b) {
  if (std::ranges::min(a) >= std::ranges::min(b)) return false;
  for (const int v : a) {
    const auto begin = of.vertex.begin() + of.begin[v],
               end = of.vertex.begin() + of.begin[std::size_t(v) + 1];
    for (const int w : b)
      if (std::binary_search(begin, end, w)) return false;
  }
  return true;
}

const MaterialNeighbours* self_of(const LmdShape& a, BodyId body_a, BodyId body_b) {
  return body_a && body_a == body_b ? a.self.get() : nullptr;
}

}  // namespace aussois
