// SPDX-License-Identifier: Apache-2.0
// What a part sweeps over a way, on a grid that contains it.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "geometry/se3.hpp"
#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct SweptVolume {
  Vec3 corner = Vec3::Zero();  // of the grid, frame of the way [m]
  double cell = 0;             // side of a cell [m]
  std::array<int, 3> cells{};  // along x, y, z
  std::vector<char>
      swept{};        // of each cell, x fastest: no point of the part is ever outside of the swept ones
  double volume = 0;  // of the swept cells [m^3]
  double error = 0;   // no point of a swept cell is farther from what is swept [m]
};

/// `n` cells along the longest side of the box. Poses are taken as joined by straight ways of all points.
/// Throws std::invalid_argument unless the mesh is a solid and n lies in [4, 512].
SweptVolume swept_volume(const SimplicialComplex& solid, const std::vector<SE3>& poses, int n = 128,
                         int threads = 1);

/// The border of the swept cells, as OBJ.
void write_swept_obj(const std::filesystem::path& path, const SweptVolume& swept);

}  // namespace aussois
