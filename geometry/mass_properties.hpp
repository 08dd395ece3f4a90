// SPDX-License-Identifier: Apache-2.0
// Volume, centre of mass and inertia of a closed oriented complex (MASS-1) to (MASS-3), and of dilated wires
// and points (MASS-4).
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct MassProperties {
  double volume = 0;            // [m^3]
  double mass = 0;              // [kg]
  Vec3 centre = Vec3::Zero();   // centre of mass, frame of the complex [m]
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, axes of the complex [kg m^2]
};

/// Exact for the polyhedron (divergence theorem). Throws std::invalid_argument unless the complex is closed
/// and oriented with a positive volume, and density > 0 [kg/m^3].
MassProperties mass_properties(const SimplicialComplex& complex, double density);

/// The same for the convex hull of the vertices: the stand-in for meshes that bound no volume (an upper bound
/// of it). Throws std::invalid_argument if the vertices are coplanar.
MassProperties convex_hull_mass_properties(const SimplicialComplex& complex, double density);

/// Of a complex without triangles that is dilated: a ball around each vertex alone, a capsule around each
/// edge (MASS-4). What several of them share counts for each. Throws std::invalid_argument if there are
/// triangles, or unless radius > 0 [m] and density > 0.
MassProperties wire_mass_properties(const SimplicialComplex& complex, double radius, double density);

}  // namespace aussois
