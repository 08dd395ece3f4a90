// SPDX-License-Identifier: Apache-2.0
// Which parts of a shape are too near each other in the material to be said to touch (DEF-4).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geometry/simplicial_complex.hpp"
#include "lmd/body_id.hpp"

namespace aussois {

struct LmdShape;

struct MaterialNeighbours {
  std::vector<int> begin{0};  // where the neighbours of each vertex begin; at the end one past the last
  std::vector<int> vertex{};  // those nearer than the reach along edges, and the vertex itself; ascending
};
/// Along the edges of a complex as it is given; `reach` in metres, > 0.
std::shared_ptr<const MaterialNeighbours> material_neighbours(const SimplicialComplex& complex, double reach);

/// Whether two simplices of a shape, given by their vertices, are looked at when it meets itself: no vertex
/// of one is a neighbour of one of the other, and the one with the lowest vertex comes first.
bool meet(const MaterialNeighbours& of, std::span<const int> a, std::span<const int> b);

/// Those of a shape that meets itself: both bodies are one and its shape has any; null otherwise.
const MaterialNeighbours* self_of(const LmdShape& a, BodyId body_a, BodyId body_b);

}  // namespace aussois
