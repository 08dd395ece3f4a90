// SPDX-License-Identifier: Apache-2.0
// Makes simple shapes as complexes, centred at the origin unless stated otherwise. Lengths in metres. Each
// function throws std::invalid_argument naming the argument, its value and its bound.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

SimplicialComplex make_point();
SimplicialComplex make_segment(double length);                     // along x
SimplicialComplex make_polyline(const std::vector<Vec3>& points);  // two or more, neighbours distinct

/// A sheet in the plane z = 0, of nx times ny rectangles, two triangles each.
SimplicialComplex make_plate(double x, double y, int nx = 1, int ny = 1);

// Solids: closed and oriented outwards.
SimplicialComplex make_box(double x, double y, double z, int subdivisions = 1);  // per edge, in [1, 256]
SimplicialComplex make_cylinder(double radius, double height, int facets);       // axis z, inscribed
SimplicialComplex make_sphere(double radius, int subdivisions);  // icosphere, 20 * 4^subdivisions, in [0, 8]
/// A simple plane polygon, given counter-clockwise, extruded from z = -height / 2 to height / 2.
SimplicialComplex make_extrusion(const std::vector<Vec2>& profile, double height);
SimplicialComplex make_torus(double major, double minor, int n_major, int n_minor);  // axis z, inscribed

/// Profile of a spur gear with straight flanks, for make_extrusion: per tooth a root, a flank, a tip and a
/// flank, each over a quarter of the pitch angle. 3 teeth or more, 0 < root < tip [m].
std::vector<Vec2> gear_profile(int teeth, double root_radius, double tip_radius);

}  // namespace aussois
