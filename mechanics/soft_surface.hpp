// SPDX-License-Identifier: Apache-2.0
// The surface of what is made of points: a body that stays where it is, whose shape moves with them.
#pragma once

#include <string>
#include <vector>

#include "geometry/simplicial_complex.hpp"
#include "lmd/body_id.hpp"
#include "mechanics/coordinates.hpp"
#include "mechanics/deformation.hpp"

namespace aussois {

struct Model;

struct SoftSurface {
  std::string name{};
  BlockId points{};
  std::vector<int> point_of{};  // the point under each vertex
  SimplicialComplex complex{};  // where the points are laid
  double radius = 0;            // [m], > 0
  bool touches_itself = false;  // but for parts nearer than four radii or two edges along it (DEF-4)
  VertexField field{};          // at its vertices
};
BodyId add(Model& model, SoftSurface surface);

}  // namespace aussois
