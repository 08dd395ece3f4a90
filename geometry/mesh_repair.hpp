// SPDX-License-Identifier: Apache-2.0
// Meshes as they come, made fit for contact (CPX-7) to (CPX-12): welded, without duplicates and triangles
// without area, closed along T-junctions, oriented. Nothing is moved farther than a tolerance, nothing is
// done in silence, and what cannot be mended stays as it is, as two-sided sheets, with the reason. Holes are
// not filled and self-intersections are not removed: both would invent a shape.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh_report.hpp"

namespace aussois {

struct RepairOptions {
  double relative_tolerance = 1e-6;  // of the box diagonal [-], in [0, 1e-2]
  // Bound of the tolerance [m], >= 0: a small part of the dilation, if the clearance is far below the size
  double largest_tolerance = kInf;
};
void validate(const RepairOptions& options);  // throws std::invalid_argument: field, value, bound

/// What one kind of repair did, and where it changed the shape most.
struct RepairStep {
  int count = 0;
  Vec3 place = Vec3::Zero();  // of the largest change, frame of the mesh [m]; of the first, if nothing moved
  double distance = 0;        // largest change of shape [m]
  void add(const Vec3& x, double moved);
};

struct RepairReport {
  double tolerance = 0;              // tau [m]
  RepairStep welded_same{};          // vertices at the place of another, merged
  RepairStep welded_near{};          // vertices nearer than tau to another, moved there
  RepairStep collapsed_triangles{};  // two of their corners were welded: dropped
  RepairStep collapsed_wires{};      // the same for wires
  RepairStep duplicate_triangles{};  // the same three vertices as an earlier one, in either winding: dropped
  RepairStep flipped_slivers{};      // triangles of no area, their long edge flipped away
  RepairStep dropped_slivers{};      // the same at an open edge, among triangles with area
  RepairStep split_edges{};          // vertices inserted into an open edge that they lie on (T-junctions)
  RepairStep turned_triangles{};     // to agree with their neighbours
  RepairStep turned_shells{};        // closed shells that faced inwards, or cavities that faced outwards
  int shells = 0;                    // closed and orientable
  int slivers_left = 0;              // triangles of no area that no flip could remove
  MeshReport before{}, after{};
  std::string reason{};  // why the result is no solid; empty for solids
  bool changed() const;
};

struct RepairedMesh {
  // `solid` if every edge has two triangles, all face outwards, and none intersects another
  SimplicialComplex complex{};
  std::vector<int> vertex{};  // where each vertex of the input went
  RepairReport report{};
};

/// A solid, and anything else that needs no repair, comes back bit for bit, with `solid` set by what was
/// found and not by what the input says. Deterministic; what is welded and split depends on places and not on
/// the order of vertices. O(n log n). Throws std::invalid_argument for a bad option.
RepairedMesh repair_mesh(const SimplicialComplex& complex, const RepairOptions& options = {});

/// A line for each kind of repair that was needed, with the number and the worst place; empty if none was.
std::string to_string(const RepairReport& report);

}  // namespace aussois
