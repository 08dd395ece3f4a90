// SPDX-License-Identifier: Apache-2.0
// Makes simple solids as volume meshes, centred at the origin. Lengths in metres. Each function throws
// std::invalid_argument naming the argument, its value and its bound.
#pragma once

#include "geometry/named.hpp"
#include "geometry/volume_mesh.hpp"

namespace aussois {

enum class CellKind { tets, hexes };  // six tetrahedra or one hexahedron for each cell of a grid
inline constexpr Named<CellKind> kCellKinds[] = {{CellKind::tets, "tets"}, {CellKind::hexes, "hexes"}};

/// A box of nx times ny times nz cells, each count in [1, 1024].
VolumeMesh make_box_mesh(const Vec3& size, const std::array<int, 3>& cells, CellKind kind = CellKind::tets);
/// Axis z; `around` cells across the diameter, even and in [2, 256], `along` of them in [1, 1024].
VolumeMesh make_cylinder_mesh(double radius, double height, int around, int along,
                              CellKind kind = CellKind::tets);
/// `across` cells across the diameter, even and in [2, 256].
VolumeMesh make_ball_mesh(double radius, int across, CellKind kind = CellKind::tets);
/// The eighth of a hollow ball with x, y, z >= 0: `along` cells along each edge and `through` through the
/// wall, each in [1, 256].
VolumeMesh make_shell_octant_mesh(double inner, double outer, int along, int through,
                                  CellKind kind = CellKind::tets);

}  // namespace aussois
