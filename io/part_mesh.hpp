// SPDX-License-Identifier: Apache-2.0
// Reads the mesh of a part as contacts want it: welded and repaired, with notes of what was done. A folder
// may keep it, so that the next run need neither read nor repair the file. See
// doc/howto/keep_prepared_shapes.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh_repair.hpp"
#include "io/cache_use.hpp"

namespace aussois {

struct PartMesh {
  SimplicialComplex complex{};       // [m]
  MeshReport report{};               // of the complex as it is
  std::vector<std::string> notes{};  // what a user must know: each repair, open surface, ...
};

/// The complex after repair_mesh, with a note for each kind of repair. What is no solid then is used as
/// two-sided sheets, with a note that says why; wires and points are what they are.
PartMesh repaired_part(const SimplicialComplex& complex, const RepairOptions& options = {});

/// The same of a mesh file, `scale` in metres per unit of the file. Errors as of read_mesh.
PartMesh read_part_mesh(const std::filesystem::path& path, double scale, const RepairOptions& options = {});

/// What a cache does: writes a mesh and reads the same bits under the same key. Throw as write_lmd_shape and
/// read_lmd_shape do.
void write_kept_mesh(const std::filesystem::path& path, const PartMesh& mesh, std::uint64_t key);
PartMesh read_kept_mesh(const std::filesystem::path& path, std::uint64_t key);

struct CachedPartMesh : CacheUse {
  PartMesh mesh{};
};

/// read_part_mesh, or the same bits from FOLDER/KEY.h5, the key made of the content of the mesh file, scale,
/// options and program. As prepare_cached otherwise.
CachedPartMesh read_part_mesh_cached(const std::filesystem::path& path, double scale,
                                     const RepairOptions& options, const std::filesystem::path& folder);

}  // namespace aussois
