// SPDX-License-Identifier: Apache-2.0
// Finds pieces of one body inside the solid of another, which contacts and distances cannot see (CA-19).
// Surfaces that a certificate keeps apart cannot become nested: one check at the start holds for ever.
#pragma once

#include <optional>
#include <string>

#include "geometry/point_in_solid.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

struct Nesting {
  bool a_in_b = false;        // pieces of A are inside B; otherwise pieces of B are inside A
  int pieces = 0, of = 0;     // connected pieces of the inner body: those inside, and all
  Vec3 place = Vec3::Zero();  // a vertex of the first piece inside, world [m]
};

/// nullopt if all pieces are outside. A complex that is not a solid has no inside; a body in a cavity is
/// outside. The pieces are those of the two complexes. Says nothing about surfaces that cross or touch: check
/// their distance first. O(vertices), plus O(triangles of the solid) for each piece whose box lies within the
/// solid's.
std::optional<Nesting> find_nesting(const PosedShape& a, const Pieces& pieces_a, const PosedShape& b,
                                    const Pieces& pieces_b);

/// "screw lies inside the solid of block", "2 of 3 pieces of screw lie inside ..., one at (x, y, z) m".
std::string to_string(const Nesting& nesting, const std::string& name_a, const std::string& name_b);

}  // namespace aussois
