// SPDX-License-Identifier: Apache-2.0
// A dilated complex prepared for contact determination: regions, chains, normal cones, classes and the
// hierarchy over its essential simplices. Immutable; shared between bodies.
#pragma once

#include <cstdint>

#include "geometry/dilated_shape.hpp"
#include "lmd/idealisation.hpp"
#include "lmd/normal_cone.hpp"
#include "lmd/normal_cone_bvh.hpp"

namespace aussois {

struct LmdShapeOptions {
  double planarity = 1e-6;  // tolerance of planar regions and straight chains, relative to the box diagonal
                            // [-], in [0, 1e-2]
};

/// What a simplex is to a contact (LMD-7); enlargement and partners depend on it.
enum class SimplexClass : std::uint8_t {
  v_corner,  // vertex with a pointed normal cone
  v_wide,    // end or bend of a wire, point, corner of a sheet: the normal cone contains a line or more
  v_node,    // vertex of a deformable body
  e_crease,  // edge with a normal arc below 180 degrees
  e_wide,    // wire, or border of a sheet
  e_soft,    // flat edge of a deformable body
  face,
  silent,  // can never carry a contact; not in the hierarchy
};

/// An essential open simplex of the idealised complex: a corner, a chain, or one side of a triangle of a
/// region.
struct Leaf {
  SimplexClass simplex_class = SimplexClass::silent;
  int dim = 0;
  int simplex = 0;                                         // vertex, chain or triangle
  int region = 0;                                          // vertex, chain or planar region
  Vec3 x[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // its corners [m]; chains: the two ends
  Vec3 direction =
      Vec3::UnitZ();  // chains: unit, from x[0] to x[1]; faces: outward normal of the region, on this side
  double extent = 0;  // chains: length [m]; faces: offset of the region's plane along `direction` [m]
  Vec3 conormal[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // faces: unit, into the triangle, in the
                                                                  // plane, at the side from x[k] to x[k + 1]
  NormalCone cone{};
};

/// Which vertices, edges and triangles of a complex the items of the base hierarchy are.
struct BaseSimplex {
  int dim = 0;  // 0 isolated vertex, 1 wire, 2 triangle
  std::array<int, 3> vertex{};
};

struct LmdShape {
  SimplicialComplex complex{};
  double radius = 0;                     // dilation [m]
  Idealisation ideal{};                  // planar regions and straight chains
  std::vector<Leaf> leaves{};            // the essential simplices with what their tests need
  NormalConeBvh bvh{};                   // over the leaves
  std::vector<BaseSimplex> simplices{};  // the top simplices of the base complex
  NormalConeBvh base{};                  // over them, for distances and the certificate
  Vec3 centre = Vec3::Zero();            // of a small ball around the vertices, frame of the shape [m]
  double bounding_radius = 0;            // of that ball, without dilation [m]
  int flat_triangles = 0;  // triangles too flat to be faces of their own; their edges still count
};

/// Throws std::invalid_argument for an empty complex, a dilation that is no length or a bad option.
LmdShape prepare(DilatedShape shape, const LmdShapeOptions& options = {});

}  // namespace aussois
