// SPDX-License-Identifier: Apache-2.0
// Reads tetrahedra and hexahedra from files of Gmsh (.msh, versions 2.2 and 4.1, text) and Medit (.mesh,
// text), coordinates in double.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/volume_mesh.hpp"

namespace aussois {

struct VolumeFile {
  VolumeMesh mesh{};  // group_of counts the groups below
  std::vector<std::string>
      groups{};     // physical names or numbers of Gmsh, references of Medit; ascending numbers
  int turned = 0;   // cells, all of which were inside out
  int dropped = 0;  // points in no cell
};
/// One line for the user; empty if nothing was changed.
std::string notes_of(const VolumeFile& file);

/// Reads by extension and multiplies coordinates by `scale` (1e-3 for a file in mm). Simplices of lower
/// dimension are passed over. Points in no cell are refused, or dropped. Throws std::runtime_error
/// "path:line: what" for anything wrong with the file, and what validate() says of the mesh;
/// std::invalid_argument unless scale is finite and > 0.
VolumeFile read_volume_mesh(const std::filesystem::path& path, double scale, bool drop_free_points = false);

}  // namespace aussois
