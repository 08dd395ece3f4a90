// SPDX-License-Identifier: Apache-2.0
// A shape that deforms: the open door for kinds of bodies of one's own (DEF-1) to (DEF-3). Its degrees of
// freedom are coordinates, bodies, or both; this says where they put the vertices of a body's shape.
#pragma once

#include <functional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct Model;
struct State;

/// How fast a vertex moves in the frame of the shape per unit of one entry of State::v.
struct VertexColumn {
  int velocity = 0;            // entry of State::v
  Vec3 column = Vec3::Zero();  // [m, or 1 for an origin]
};

/// Where the vertices of a shape are in its frame: affine functions of the coordinates and of the origins of
/// other bodies, so that on the path of a step they move straight (DEF-2). Both functions empty: the shape is
/// rigid.
struct Deformation {
  /// All vertices at a state [m], in the order of the shape's.
  std::function<std::vector<Vec3>(const Model&, const State&)> vertices{};
  /// Appends what moves one vertex.
  std::function<void(const Model&, const State&, int vertex, std::vector<VertexColumn>&)> columns{};
};

}  // namespace aussois
