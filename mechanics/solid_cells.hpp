// SPDX-License-Identifier: Apache-2.0
// Where the energy of a solid is summed: deformation gradients that are linear in the places of points, and
// means of the change of volume over them (FEM-1), (FEM-2).
#pragma once

#include <span>
#include <vector>

#include "geometry/volume_mesh.hpp"

namespace aussois {

struct SolidCells {
  /// A gradient with the rest volume that it stands for.
  struct Part {
    int map = 0;
    double volume = 0;  // [m^3]
    int group = 0;      // VolumeMesh::group_of
    int cell = 0;       // the first of those that it is taken from
  };
  // F of map k is the sum over its points of x_a G_a^T (FEM-1)
  std::vector<int> first{0};       // where each map begins in `point`; at the end one past the last
  std::vector<int> point{};        // of the mesh
  std::vector<Vec3> gradient{};    // G [1/m]
  std::vector<Part> shape{};       // where strain has energy
  std::vector<int> mean_first{0};  // where each mean begins in `mean`; at the end one past the last
  std::vector<Part> mean{};        // of the change of volume; empty: `shape` has its energy too

  std::size_t maps() const { return first.size() - 1; }
  std::size_t means() const { return mean_first.size() - 1; }
  std::span<const int> points(int map) const;
  std::span<const Vec3> gradients(int map) const;
  std::span<const Part> parts(std::size_t mean) const;
};

/// `smooth_strain`: strain of tetrahedra is averaged around their edges; `mean_volume`: the change of volume
/// is, around points, and in each hexahedron. Nothing is averaged over groups.
SolidCells solid_cells(const VolumeMesh& mesh, bool smooth_strain, bool mean_volume);

Mat3 deformation_gradient(const SolidCells& cells, int map, const std::vector<Vec3>& places);

}  // namespace aussois
