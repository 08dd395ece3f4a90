// SPDX-License-Identifier: Apache-2.0
// Makes a surface of fewer triangles. How far it is off is for the caller to prove.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// Whether the complex consists of triangles alone: no wires, no points.
bool is_surface(const SimplicialComplex& complex);

/// A surface with vertices of `complex`, which must be a surface itself, made by collapsing edges
/// [Garland1997]. The maker aims at `distance` [m] from the original and promises nothing. A solid if the
/// result is closed, faces outwards and does not pass through itself, otherwise sheets. Throws
/// std::invalid_argument for a complex with wires or points, or a distance that is not finite and positive.
SimplicialComplex coarse_surface(const SimplicialComplex& complex, double distance);

}  // namespace aussois
