// SPDX-License-Identifier: Apache-2.0
// A dilated complex prepared for contact determination: regions, chains, normal cones, classes and the hierarchy over
// its essential simplices. Immutable; shared between bodies.
#pragma once

#include "geometry/dilated_shape.hpp"
#include "lmd/idealisation.hpp"
#include "lmd/normal_cone.hpp"
#include "lmd/normal_cone_bvh.hpp"

namespace aussois {

struct LmdShapeOptions {
  double planarity = 1e-6;  // tolerance of planar regions and straight chains, relative to the box diagonal [-], in [0, 1e-2]
};

struct LmdShape {
  SimplicialComplex complex{};
  double radius = 0;               // dilation [m]
  Idealisation ideal{};            // planar regions and straight chains
  std::vector<Leaf> leaves{};      // the essential simplices with what their tests need
  NormalConeBvh bvh{};             // over the leaves
  NormalConeBvh base{};            // over the simplices of the base complex, for distances and the certificate
  Vec3 centre = Vec3::Zero();      // of a small ball around the vertices, frame of the shape [m]
  double bounding_radius = 0;      // of that ball, without dilation [m]
};

/// Throws std::invalid_argument for an empty complex, a triangle of zero area or a bad option.
LmdShape prepare(DilatedShape shape, const LmdShapeOptions& options = {});

}  // namespace aussois
