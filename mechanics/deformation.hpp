// SPDX-License-Identifier: Apache-2.0
// A shape that deforms: the extension point for user-defined kinds of bodies (DEF-1) to (DEF-3). Its degrees
// of freedom are coordinates, bodies, or both; a Deformation says where they put the vertices of a body's
// shape.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct Model;
struct State;

/// How a vertex moves in the frame of the shape per unit of one entry of State::v.
struct VertexColumn {
  int velocity = 0;            // entry of State::v
  Vec3 column = Vec3::Zero();  // [m, or 1 for an origin]
  Vec3 turn = Vec3::Zero();    // how what surrounds it turns: [rad, or 1 for a body's rotation] (DEF-3)
};

/// A number at every vertex of a shape that says how it is loaded, for recordings and pictures; no step reads
/// it.
struct VertexField {
  std::string what{}, unit{};  // "von Mises stress", "Pa"
  std::function<std::vector<double>(const Model&, const State&)> values{};
};

/// Where the vertices of a shape are, in its frame. They must be affine functions of the coordinates and of
/// the origins of other bodies, so that they move straight on the path of a step (DEF-2). If both functions
/// are empty, the shape is rigid.
struct Deformation {
  /// All vertices at a state [m], in the order of the shape's vertices.
  std::function<std::vector<Vec3>(const Model&, const State&)> vertices{};
  /// Appends the columns that move one vertex.
  std::function<void(const Model&, const State&, int vertex, std::vector<VertexColumn>&)> columns{};
  VertexField field{};  // by default none
};

}  // namespace aussois
