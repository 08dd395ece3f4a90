// SPDX-License-Identifier: Apache-2.0
#include "lmd/feature_incidence.hpp"

#include <algorithm>
#include <cstdlib>

namespace aussois {

std::size_t feature_count(const LmdShape& shape, int dim) {
  if (dim == 0) return shape.complex.vertices.size();
  return dim == 1 ? shape.edges.size() : dim == 2 ? shape.regions.size() : 0;
}

bool incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g) {
  if (f.dim == g.dim) return f.region == g.region;
  if (f.dim > g.dim) return incident(shape, g, f);
  if (f.dim == 0 && g.dim == 1) {
    const EdgeLeaf& chain = shape.edges[g.region];
    return chain.first == f.region || chain.last == f.region;
  }
  if (f.dim == 1)
    return std::ranges::any_of(shape.edges[f.region].conormals,
                               [&](int region) { return std::abs(region) == g.region + 1; });
  return std::ranges::any_of(shape.complex.vertex_triangles[f.region],
                             [&](int t) { return shape.triangle_region[t] == g.region; });
}

}  // namespace aussois
