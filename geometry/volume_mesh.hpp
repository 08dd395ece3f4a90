// SPDX-License-Identifier: Apache-2.0
// Solids cut into tetrahedra and hexahedra: the cells of finite elements.
#pragma once

#include <array>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

using Tet = std::array<int, 4>;  // the last point lies where the normal of the first three leads
/// Corners 0 to 3 around one face, counter-clockwise seen from inside, and 4 to 7 across from them.
using Hex = std::array<int, 8>;

struct VolumeMesh {
  std::vector<Vec3> points{};  // [m]
  std::vector<Tet> tets{};
  std::vector<Hex> hexes{};
  std::vector<int> group_of{};  // a number of each cell, tetrahedra first, such as its material; empty: 0

  std::size_t cells() const { return tets.size() + hexes.size(); }
};

double volume(const VolumeMesh& mesh, const Tet& tet);  // [m^3], negative if it is inside out

/// Where an integral over a hexahedron is taken: its points by Gauss, with the gradients of the eight shape
/// functions there.
struct HexPoint {
  double volume = 0;               // [m^3]
  std::array<Vec3, 8> gradient{};  // [1/m]
};
std::array<HexPoint, 8> hex_points(const VolumeMesh& mesh, const Hex& hex);
double volume(const VolumeMesh& mesh, const Hex& hex);  // the sum of its points' [m^3]

/// The faces that belong to one cell only, counter-clockwise seen from outside; a face of a hexahedron is two
/// triangles. In the order of the cells.
std::vector<std::array<int, 3>> boundary_triangles(const VolumeMesh& mesh);

/// Throws std::invalid_argument unless there are cells, every point is finite and in a cell, every cell has
/// corners that exist and differ and a volume above 1e-12 of its size cubed, no face belongs to more than two
/// cells, and cells that share a point are joined by faces. The message names the first cell or point that is
/// wrong and says how many are.
void validate(const VolumeMesh& mesh);

/// Turns all cells if each one is inside out; returns how many. Mixed cells are left to validate().
int turn_outside_out(VolumeMesh& mesh);

}  // namespace aussois
