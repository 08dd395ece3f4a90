// SPDX-License-Identifier: Apache-2.0
// Makes raw meshes fit for contact (CPX-7) to (CPX-12): welds vertices, removes duplicates and triangles
// without area, closes T-junctions, orients the triangles. Nothing moves farther than a tolerance, and every
// change is reported. What cannot be mended stays as it is, as two-sided sheets, and the reason is given.
// Holes are not filled and self-intersections are not removed: either would invent a shape.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh_report.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct RepairOptions {
  double relative_tolerance = 1e-6;  // relative to the box diagonal [-]
  // Upper bound of the tolerance [m]. Use a small part of the dilation if the clearance is far below
  // the size of the mesh.
  double largest_tolerance = kInf;
};
void validate(const RepairOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, RepairOptions& options);

/// What one kind of repair did, and where it changed the shape most.
struct RepairStep {
  int count = 0;
  Vec3 place = Vec3::Zero();  // of the largest change, frame of the mesh [m]; of the first, if nothing moved
  double distance = 0;        // largest change of shape [m]
  void add(const Vec3& x, double moved);
};

struct RepairReport {
  double tolerance = 0;              // tau [m]
  RepairStep welded_same{};          // vertices coincident with another, merged
  RepairStep welded_near{};          // vertices nearer than tau to another, moved there
  RepairStep collapsed_triangles{};  // with two corners welded: dropped
  RepairStep collapsed_wires{};      // the same for wires
  RepairStep duplicate_triangles{};  // same three vertices as an earlier one, in either winding: dropped
  RepairStep flipped_slivers{};      // triangles without area, their long edge flipped away
  RepairStep dropped_slivers{};      // the same at an open edge, among triangles with area
  RepairStep split_edges{};          // vertices inserted into an open edge that they lie on (T-junctions)
  RepairStep turned_triangles{};     // turned over to agree with their neighbours
  RepairStep turned_shells{};        // closed shells that faced inwards, or cavities that faced outwards
  int shells = 0;                    // closed and orientable
  int slivers_left = 0;              // triangles without area that no flip could remove
  MeshReport before{}, after{};
  std::string reason{};  // why the result is not a solid; empty for solids
  bool changed() const;
};

struct RepairedMesh {
  // `solid` if every edge has two triangles, all face outwards, and none intersects another
  SimplicialComplex complex{};
  std::vector<int> vertex{};  // new index of each input vertex
  RepairReport report{};
};

/// A solid, and anything else that needs no repair, comes back bit for bit, with `solid` set from what was
/// found, not from what the input says. Deterministic; what is welded and split depends on positions, not on
/// the order of vertices. O(n log n). Throws std::invalid_argument for a bad option.
RepairedMesh repair_mesh(const SimplicialComplex& complex, const RepairOptions& options = {});

/// One line for each kind of repair that was needed, with its count and worst place; empty if none was.
std::string to_string(const RepairReport& report);

}  // namespace aussois
