// SPDX-License-Identifier: Apache-2.0
// Groups directions by the cell of a cube's surface that they point to (CLU-1), (CLU-2). Nothing is allocated
// per cell. Source: [Moravanszky2004]; the merging of cells is ours.
#pragma once

#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct CubeMapOptions {
  int cells = 4;              // per edge of the cube
  bool equi_angular = false;  // cells of about the same solid angle (CLU-2)
  double merge = 0;  // neighbouring cells whose mean directions differ by at most this are merged [rad], in
                     // [0, pi/2]; 0: never
};
void validate(const CubeMapOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, CubeMapOptions& options);

/// The cell that a direction points to, in [0, 6 cells^2). Throws std::invalid_argument unless the direction
/// has unit length (1e-6).
int cube_cell(const Vec3& direction, const CubeMapOptions& options = {});

/// One label per direction; groups are numbered in the order of their lowest cells. Apart from rounding in
/// sums, the order of the directions does not matter.
struct CubeMap {
  std::vector<int> label{};
  int groups = 0;
};
CubeMap cube_map(std::span<const Vec3> directions, const CubeMapOptions& options = {});

}  // namespace aussois
