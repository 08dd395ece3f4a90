// SPDX-License-Identifier: Apache-2.0
// Recovers what a CAD mesh means: planar regions of triangles and straight chains of edges between them
// (LMD-4), (LMD-5). Normal cones, feet and keys are taken from regions and chains, so contacts do not depend
// on the triangulation.
#pragma once

#include <span>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// A straight piece of the border between regions, a border of a sheet, or a straight piece of wire.
struct Chain {
  int first = 0, last = 0;         // its end vertices
  int begin = 0, edge_count = 1;   // of its path, see edges_of and vertices_of
  Vec3 direction = Vec3::UnitX();  // unit, from first to last
};

/// A vertex inside a chain that was moved onto the chord.
struct MovedVertex {
  int vertex = 0;
  Vec3 from = Vec3::Zero();  // where it was [m]
  bool operator==(const MovedVertex&) const = default;
};

struct Idealisation {
  double tolerance = 0;  // tau_f [m]
  std::vector<int> triangle_region{};
  std::vector<double>
      triangle_sign{};  // +1 if the triangle faces as its region does, -1 otherwise (sheets only)
  std::vector<Vec3> region_normal{};    // unit
  std::vector<double> region_offset{};  // the region's plane is { x : normal . x = offset } [m]
  std::vector<Chain> chains{};
  std::vector<int> path_edges{}, path_vertices{};  // of all chains, one after the other
  std::vector<int> edge_chain{};                   // -1: inside a region, silent
  Incidence vertex_chains{};                       // chains that end at a vertex
};

/// The edges of a chain, and the vertices from first to last: edge k joins vertices k and k + 1.
inline std::span<const int> edges_of(const Idealisation& ideal, const Chain& chain) {
  return std::span(ideal.path_edges).subspan(std::size_t(chain.begin), std::size_t(chain.edge_count));
}
inline std::span<const int> vertices_of(const Idealisation& ideal, int chain) {
  const Chain& c = ideal.chains[chain];  // each chain before it has one vertex more than edges
  return std::span(ideal.path_vertices).subspan(std::size_t(c.begin + chain), std::size_t(c.edge_count) + 1);
}

/// Regions grow from the largest triangle over manifold edges while all vertices stay within `tolerance` of
/// the seed's plane and the normal within 1 degree (slivers excepted). Chains are split where they leave a
/// straight line by more than `tolerance`.
Idealisation idealise(const SimplicialComplex& complex, double tolerance);
/// Makes each triangle a region and each edge a chain, with its own index, wherever the vertices are.
Idealisation idealise_each(const SimplicialComplex& complex, double tolerance);

/// Moves the vertices inside chains onto the chords if they are off by more than `foot`. The faces on both
/// sides then end where the chain begins, and no slit is left between them (LMD-14). Vertices move by at most
/// the tolerance of the idealisation, which holds for the straightened complex as well.
std::vector<MovedVertex> straighten_chains(SimplicialComplex& complex, const Idealisation& ideal,
                                           double foot);

/// For each vertex, how far chords and planes that meet there are from parallel: the sum of the two largest
/// sines |n . d| of a chain's direction d and the normal n of a region beside it (LMD-15); 0 below 1e-6.
std::vector<double> misfit_at_vertices(const SimplicialComplex& complex, const Idealisation& ideal);

}  // namespace aussois
