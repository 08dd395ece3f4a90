// SPDX-License-Identifier: Apache-2.0
// The steps of repair_mesh, each from a complex to a complex. Lengths in metres.
#pragma once

#include <vector>

#include "geometry/mesh_repair.hpp"

namespace aussois {

/// Edges that are no side of a triangle, for make_complex.
std::vector<std::array<int, 2>> wires_of(const SimplicialComplex& complex);

struct Welded {
  SimplicialComplex complex{};
  std::vector<int> vertex{};  // where each vertex went
  RepairStep vertices{}, collapsed_triangles{}, collapsed_wires{};
};
/// Merges vertices nearer than `tolerance` (0: at the same place) (CPX-7). The one with the smallest
/// coordinates stays where it is; in its new number it takes the place of the first of its group.
Welded weld_vertices(const SimplicialComplex& complex, double tolerance);

struct Distinct {
  SimplicialComplex complex{};
  RepairStep dropped{};
};
/// Keeps the first of several triangles with the same three vertices.
Distinct drop_duplicate_triangles(const SimplicialComplex& complex);

struct Flipped {
  SimplicialComplex complex{};
  RepairStep flipped{}, dropped{};
  int left = 0;
};
/// Flips the longest edge of every triangle of height up to `tolerance` into its neighbour (CPX-8), (CPX-9).
Flipped flip_slivers(const SimplicialComplex& complex, double tolerance);

struct Split {
  SimplicialComplex complex{};
  RepairStep inserted{};
};
/// Inserts vertices into the open edges that they lie on within `tolerance`, where this makes edges meet
/// (CPX-10), (CPX-11).
Split split_t_junctions(const SimplicialComplex& complex, double tolerance);

struct Oriented {
  SimplicialComplex complex{};
  RepairStep turned_triangles{}, turned_shells{};
  int shells = 0;       // closed and orientable
  int one_sided = 0;    // pieces that have no orientation, left as they were
  int flat_shells = 0;  // closed, with a volume that rounding cannot tell from zero
};
/// Makes the triangles of each piece agree, fewest of them turned, and closed shells face outwards, those at
/// odd depth of nesting inwards (CPX-12).
Oriented orient_surface(const SimplicialComplex& complex);

}  // namespace aussois
