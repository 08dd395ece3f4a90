// SPDX-License-Identifier: Apache-2.0
// Masses of the points of a solid (FEM-7).
#pragma once

#include <vector>

#include "geometry/volume_mesh.hpp"
#include "mechanics/solid.hpp"

namespace aussois {

/// The points of boundary triangles, ascending.
std::vector<int> surface_points(const VolumeMesh& mesh);

/// Mass of each point [kg]. With SolidMass::redistributed, those that are `touching` (empty: those of the
/// surface) give theirs away where other points share a cell with them. The sum is the mass of the solid, and
/// the centre is that of lumped masses. Throws std::invalid_argument if a mass would be negative.
std::vector<double> point_masses(const VolumeMesh& mesh, const std::vector<Material>& materials,
                                 SolidMass how, const std::vector<int>& touching = {});

}  // namespace aussois
