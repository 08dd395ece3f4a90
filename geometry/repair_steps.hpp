// SPDX-License-Identifier: Apache-2.0
// The steps of repair_mesh; each takes a complex and returns one. Lengths in metres.
#pragma once

#include <vector>

#include "geometry/mesh_repair.hpp"

namespace aussois {

/// The edges that are not a side of any triangle, for make_complex.
std::vector<std::array<int, 2>> wires_of(const SimplicialComplex& complex);

struct WeldedComplex {
  SimplicialComplex complex{};
  std::vector<int> vertex{};  // new index of each vertex
  RepairStep vertices{}, collapsed_triangles{}, collapsed_wires{};
};
/// Merges vertices nearer than `tolerance` (0: at the same place) (CPX-7). Of each group the vertex with the
/// smallest coordinates stays where it is; in the new numbering it takes the place of the first of the group.
WeldedComplex weld_vertices(const SimplicialComplex& complex, double tolerance);

struct DistinctComplex {
  SimplicialComplex complex{};
  RepairStep dropped{};
};
/// Of several triangles with the same three vertices, keeps the first.
DistinctComplex drop_duplicate_triangles(const SimplicialComplex& complex);

struct FlippedComplex {
  SimplicialComplex complex{};
  RepairStep flipped{}, dropped{};
  int left = 0;
};
/// Flips the longest edge of every triangle no higher than `tolerance` into its neighbour (CPX-8), (CPX-9).
FlippedComplex flip_slivers(const SimplicialComplex& complex, double tolerance);

struct SplitComplex {
  SimplicialComplex complex{};
  RepairStep inserted{};
};
/// Inserts vertices into open edges that they lie on to within `tolerance`, where this makes edges meet
/// (CPX-10), (CPX-11).
SplitComplex split_t_junctions(const SimplicialComplex& complex, double tolerance);

struct OrientedComplex {
  SimplicialComplex complex{};
  RepairStep turned_triangles{}, turned_shells{};
  int shells = 0;       // closed and orientable
  int one_sided = 0;    // pieces that cannot be oriented, left as they were
  int flat_shells = 0;  // closed, with a volume that is zero to rounding
};
/// Makes the triangles of each piece agree, turning over as few as possible. Makes closed shells face
/// outwards, those at odd nesting depth inwards (CPX-12).
OrientedComplex orient_surface(const SimplicialComplex& complex);

}  // namespace aussois
