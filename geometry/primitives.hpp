// SPDX-License-Identifier: Apache-2.0
// Simple shapes as complexes, centred at the origin unless said. Lengths in metres; each throws
// std::invalid_argument naming the argument, its value and its bound.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

SimplicialComplex make_point();
SimplicialComplex make_segment(double length);                       // along x
SimplicialComplex make_polyline(const std::vector<Vec3>& points);    // at least two points
SimplicialComplex make_plate(double x, double y, int nx = 1, int ny = 1);  // a sheet in the plane z = 0
SimplicialComplex make_box(double x, double y, double z, int subdivisions = 1);  // a solid
SimplicialComplex make_cylinder(double radius, double height, int facets);       // a solid, axis z
SimplicialComplex make_sphere(double radius, int subdivisions);      // a solid: icosphere, vertices on the sphere
SimplicialComplex make_torus(double major, double minor, int n_major, int n_minor);  // a solid, axis z

}  // namespace aussois
