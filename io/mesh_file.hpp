// SPDX-License-Identifier: Apache-2.0
// Reads surfaces, wires and points from OBJ, STL, PLY and OFF files, all coordinates in double. A file is
// taken at its word or refused: nothing is repaired, and the few changes made on reading are counted in the
// notes.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// What was done to the content of the file.
struct MeshFileNotes {
  int fanned_polygons = 0;      // polygons of four or more corners, cut into a fan from their first corner
  int collapsed_triangles = 0;  // triangles that name a vertex twice, dropped
  int collapsed_wires = 0;      // the same for wires
  int welded_vertices = 0;      // vertices at exactly the place of an earlier one, merged into it
  int unused_vertices = 0;      // vertices that no simplex names, dropped (but a file of vertices alone keeps
                                // them as its points)
};
/// One line for the user; empty if nothing was done.
std::string to_string(const MeshFileNotes& notes);

/// Ready for make_complex: `points` holds exactly the vertices that are in no triangle and no wire.
struct MeshFile {
  std::vector<Vec3> vertices{};                 // [m] if `scale` was metres per unit of the file
  std::vector<std::array<int, 3>> triangles{};  // corners in the order of the file
  std::vector<std::array<int, 2>> wires{};      // OBJ `l`, PLY element `edge`
  std::vector<int> points{};                    // OBJ `p`, or a file of vertices alone; ascending
  MeshFileNotes notes{};
};

/// Reads by extension (.obj .stl .ply .off, any case) and multiplies coordinates by `scale` (1e-3 for a file
/// in mm). OBJ: v, f (v, v/vt, v//vn, v/vt/vn, negative indices), l, p; STL: ascii and binary, welded where
/// coordinates are equal; PLY: ascii and binary of either byte order; OFF: ascii, with or without colours and
/// normals. Throws std::runtime_error "path:line: what" (binary files: the byte instead of the line) for
/// anything wrong with the file, std::invalid_argument unless scale is finite and > 0.
MeshFile read_mesh(const std::filesystem::path& path, double scale);

/// Merges vertices with equal coordinates and drops triangles and wires that collapse; adds to the notes. For
/// files that split vertices by their normals or colours; STL is already welded.
void weld_mesh_file(MeshFile& mesh);

/// Writes OBJ (v, f, l, p) with coordinates divided by `scale`, under a temporary name that is then renamed.
/// Coordinates read back as the same doubles if scale is 1. Throws std::runtime_error if the file cannot be
/// written.
void write_obj(const std::filesystem::path& path, const MeshFile& mesh, double scale);

}  // namespace aussois
