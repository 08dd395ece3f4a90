// SPDX-License-Identifier: Apache-2.0
#include "lmd/feature_incidence.hpp"

#include <algorithm>
#include <cstdlib>

namespace aussois {

std::size_t feature_count(const LmdShape& shape, int dim) {
  if (dim == 0) return shape.complex.vertices.size();
  if (dim == 1) return shape.deforming ? shape.complex.edges.size() : shape.edges.size();
  if (dim == 2) return shape.deforming ? shape.complex.triangles.size() : shape.regions.size();
  return 0;
}

bool are_incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g) {
  if (f.dim == g.dim) return f.region == g.region;
  if (f.dim > g.dim) return are_incident(shape, g, f);
  if (f.dim == 0 && g.dim == 1) {
    const auto [first, last] = chain_ends(shape, g.region);
    return first == f.region || last == f.region;
  }
  if (f.dim == 1 && shape.deforming) {
    const std::span<const int> on = shape.complex.edge_triangles[f.region];
    return std::ranges::find(on, g.region) != on.end();
  }
  if (f.dim == 1)
    return std::ranges::any_of(shape.edges[f.region].conormals,
                               [&](int region) { return std::abs(region) == g.region + 1; });
  return std::ranges::any_of(shape.complex.vertex_triangles[f.region],
                             [&](int t) { return shape.triangle_region[t] == g.region; });
}

}  // namespace aussois
