// SPDX-License-Identifier: Apache-2.0
// Reports the state of a mesh before anything is computed with it. Repairs nothing.
#pragma once

#include <string>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct MeshReport {
  int vertices = 0, edges = 0, triangles = 0, components = 0;
  int isolated_vertices = 0, wire_edges = 0;
  int border_edges = 0;           // edges with one triangle
  int non_manifold_edges = 0;     // edges with three or more triangles
  int non_manifold_vertices = 0;  // vertices whose triangles form more than one fan
  int misoriented_edges = 0;      // edges that their two triangles traverse in the same direction
  int degenerate_triangles = 0;   // height below 1e-12 of the bounding box diagonal
  int duplicate_vertices = 0;     // vertices exactly coincident with an earlier one
  int duplicate_triangles = 0;    // with the same three vertices as an earlier one
  // Pairs of triangles that meet anywhere but in a vertex or edge they share (self_intersections)
  int self_intersections = 0;
  // Smallest triangle height over the bounding box diagonal; 0 without triangles
  double min_height_ratio = 0;
  Box box{};
  double volume = 0;      // signed, of the closed oriented surface [m^3]; 0 if not closed and oriented
  bool closed = false;    // there are triangles, and every edge has two of them
  bool oriented = false;  // there are triangles, and no edge is misoriented or non-manifold
  bool manifold = false;  // nothing but triangles, no non-manifold edge or vertex; a border is allowed
  bool solid() const { return closed && oriented && volume > 0; }
};

MeshReport report_mesh(const SimplicialComplex& complex);
/// Several lines for people; lengths in metres, the box in millimetres, so that a wrong unit stands out.
std::string to_string(const MeshReport& report);

/// Height of the triangle over its longest side [m].
double triangle_height(const Vec3& a, const Vec3& b, const Vec3& c);

/// For each vertex, the index of the first one with equal coordinates (its own if there is no earlier one).
std::vector<int> first_at_same_place(std::span<const Vec3> vertices);

}  // namespace aussois
