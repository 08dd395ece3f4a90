// SPDX-License-Identifier: Apache-2.0
// Computes volume, centre of mass and inertia of a closed oriented complex (MASS-1) to (MASS-3), and of
// dilated wires and points (MASS-4).
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

/// The same for the convex hull of the vertices: a stand-in for meshes that bound no volume, and an upper
/// bound of the volume. Throws std::invalid_argument if the vertices are coplanar.
MassProperties convex_hull_mass_properties(const SimplicialComplex& complex, double density);

/// The same for a dilated complex without triangles: a ball around each isolated vertex, a capsule around
/// each edge (MASS-4). Where several overlap, the overlap counts once for each. Throws std::invalid_argument
/// if there are triangles, or unless radius > 0 [m] and density > 0.
MassProperties wire_mass_properties(const SimplicialComplex& complex, double radius, double density);

}  // namespace aussois
