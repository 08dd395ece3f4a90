// SPDX-License-Identifier: Apache-2.0
// Directions by the cell of a cube's surface that they point to (CLU-1), (CLU-2). Nothing is allocated per
// cell. Source: [Moravanszky2004]; merging of cells is ours.
#pragma once

#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct CubeMapOptions {
  int cells = 4;              // per edge of the cube, in [1, 1024]
  bool equi_angular = false;  // cells of about the same solid angle (CLU-2)
  double merge = 0;  // neighbouring cells whose mean directions differ by at most this are one [rad], in
                     // [0, pi/2]; 0: never
};
void validate(const CubeMapOptions& options);  // throws std::invalid_argument: field, value, bound

/// Cell of a unit direction, in [0, 6 cells^2). Throws std::invalid_argument unless the direction is of unit
/// length (1e-6).
int cube_cell(const Vec3& direction, const CubeMapOptions& options = {});

/// A label per direction, numbered by the lowest cell of each group. Does not depend on the order of the
/// directions, but for rounding in their sums.
struct CubeMap {
  std::vector<int> label{};
  int groups = 0;
};
CubeMap cube_map(std::span<const Vec3> directions, const CubeMapOptions& options = {});

}  // namespace aussois
