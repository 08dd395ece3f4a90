// SPDX-License-Identifier: Apache-2.0
// What a mesh is before anybody computes with it. Nothing is repaired here.
#pragma once

#include <string>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct MeshReport {
  int vertices = 0, edges = 0, triangles = 0, components = 0;
  int isolated_vertices = 0, wire_edges = 0;
  int border_edges = 0;            // edges with one triangle
  int non_manifold_edges = 0;      // edges with three or more triangles
  int misoriented_edges = 0;       // edges whose two triangles run through them in the same direction
  int degenerate_triangles = 0;    // height below 1e-12 of the bounding box diagonal
  int duplicate_vertices = 0;      // vertices at exactly the place of an earlier one
  int duplicate_triangles = 0;     // same three vertices as an earlier one
  int self_intersections = -1;     // intersecting triangle pairs; -1: not computed (built without GPL parts)
  double min_height_ratio = 0;     // smallest triangle height over the bounding box diagonal
  Box box{};
  double volume = 0;               // signed, of the closed oriented surface [m^3]; 0 if not closed
  bool closed = false, oriented = false, manifold = false;
  bool solid() const { return closed && oriented && volume > 0; }
};

MeshReport report_mesh(const SimplicialComplex& complex);
/// Several lines for people; lengths in metres and the box in millimetres, so that a wrong unit is seen.
std::string to_string(const MeshReport& report);

}  // namespace aussois
