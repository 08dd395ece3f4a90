// SPDX-License-Identifier: Apache-2.0
// Is a piece of one body inside the solid of another, where contacts and distances see nothing of it? (CA-19)
// Surfaces that a certificate keeps apart cannot bring it about: asked once, at the start, it holds for ever.
#pragma once

#include <optional>
#include <string>

#include "geometry/point_in_solid.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

struct Nesting {
  bool a_in_b = false;        // pieces of A are inside B; otherwise pieces of B inside A
  int pieces = 0, of = 0;     // so many of its connected pieces, of all of them
  Vec3 place = Vec3::Zero();  // a vertex of the first of them, world [m]
};

/// Nothing if all pieces are outside. What is no solid has no inside; bodies in a cavity are outside. Pieces
/// are those of the two complexes. Says nothing of surfaces that cross or touch: ask for their distance
/// first. O(vertices), and O(triangles of the solid) for each piece whose box lies within the solid's.
std::optional<Nesting> find_nesting(const PosedShape& a, const Pieces& pieces_a, const PosedShape& b,
                                    const Pieces& pieces_b);

/// "screw lies inside the solid of block", "2 of 3 pieces of screw lie inside ..., one at (x, y, z) m".
std::string to_string(const Nesting& nesting, const std::string& name_a, const std::string& name_b);

}  // namespace aussois
