// SPDX-License-Identifier: Apache-2.0
// Tells which features a shape has, and which of them contain which others.
#pragma once

#include <array>
#include <cstdlib>

#include "lmd/contact_point.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// How many features of a dimension a shape has: vertices, chains, regions. Their indices are below it.
std::size_t feature_count(const LmdShape& shape, int dim);

/// The vertices where a chain ends. Chains of a shape that deforms are its edges.
inline std::array<int, 2> chain_ends(const LmdShape& shape, int chain) {
  if (shape.deforming) return shape.complex.edges[chain];
  return {shape.edges[chain].first, shape.edges[chain].last};
}

/// True if the two are the same, or if one lies in the border of the other: a vertex that ends a chain or is
/// a corner of a region's triangle, or a chain that borders a region. The shape must have both.
bool are_incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g);

/// Calls visit(g) for the features that f leads to, some of them twice: the ends and regions of a chain, the
/// regions of a vertex. Two that differ are incident if and only if one leads to the other.
void for_each_led_to(const LmdShape& shape, const KeyFeature& f, auto&& visit) {
  if (f.dim == 0)
    for (int t : shape.complex.vertex_triangles[f.region]) visit(KeyFeature{2, shape.triangle_region[t]});
  if (f.dim != 1) return;
  for (int end : chain_ends(shape, f.region)) visit(KeyFeature{0, end});
  if (shape.deforming)
    for (int region : shape.complex.edge_triangles[f.region]) visit(KeyFeature{2, region});
  else
    for (int region : shape.edges[f.region].conormals)
      if (region != 0) visit(KeyFeature{2, std::abs(region) - 1});
}

}  // namespace aussois
