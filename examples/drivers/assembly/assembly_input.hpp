// SPDX-License-Identifier: Apache-2.0
// Two parts and a recorded path of one in the frame of the other: from a data folder, from files, or of our
// own making.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mass_properties.hpp"
#include "geometry/settings.hpp"
#include "io/part_mesh.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

struct AssemblyPart {
  std::string name{};
  SimplicialComplex complex{};       // [m]
  MeshReport report{};               // of the complex as it is used
  std::vector<std::string> notes{};  // what a user must know, each with the name of the part
  CacheUse cache{};                  // of the mesh
};

struct AssemblyInput {
  std::string name{};
  AssemblyPart fixed{}, moving{};
  std::vector<SE3> poses{};                  // of the moving part's mesh in the frame of the fixed part's
  std::vector<std::string> place_of_pose{};  // "path.csv:12"; empty if they are of our own making
  std::string fingerprint{};                 // of the content of all files, as text
};

/// The part named after its mesh file (read_part_mesh_cached).
AssemblyPart read_part(const std::filesystem::path& path, double scale, const RepairOptions& options = {},
                       const std::filesystem::path& cache = {});

/// The largest way from a vertex of the mesh to where the shape has it, on the chord of its chain (LMD-5)
/// [m].
double straightened_by(const LmdShape& shape);

/// Adds a note to the part if vertices of its mesh were put on chords when the shape was prepared: how many,
/// and the largest way.
void note_straightened(AssemblyPart& part, const LmdShape& shape);

/// DIR/assembly/pairs.csv names the meshes (DIR/meshes/NAME.obj) and the path (DIR/assembly/FILE). Throws
/// std::invalid_argument with the known names if `pair` is none of them.
AssemblyInput read_assembly_pair(const std::filesystem::path& data, const std::string& pair, double scale,
                                 const std::filesystem::path& cache = {});

AssemblyInput read_assembly_files(const std::filesystem::path& fixed, const std::filesystem::path& moving,
                                  const std::filesystem::path& path, double scale,
                                  const std::filesystem::path& cache = {});

/// Shapes of our own: "bolt_nut", a nut unscrewed from its bolt by a turn and a half.
AssemblyInput builtin_assembly(const std::string& name);

/// Mass of a part: of its volume if it is a solid; of its balls and capsules (MASS-4) if it has no triangles;
/// otherwise of its convex hull. `mass` > 0 replaces the total [kg].
struct PartMass {
  MassProperties properties{};
  std::string source{};  // "solid", "balls and capsules", "convex hull", with ", given mass" if it was
};
inline constexpr Range kPartDensity{1e-3, 1e5};  // [kg/m^3]
inline constexpr Range kPartMass{0, 1e6};        // [kg]
PartMass part_mass(const AssemblyPart& part, double dilation, double density, double mass);

}  // namespace aussois
