// SPDX-License-Identifier: Apache-2.0
// Which triangles of a soup pass through each other, decided by exact arithmetic.
#pragma once

#include <array>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// Pairs (i < j, ascending) of triangles that meet elsewhere than in the vertex or edge they share; vertices
/// at the same place count as shared, so a surface with split vertices is judged like the welded one. Two
/// triangles with the same three places are a pair, and so are two that touch without sharing a vertex there
/// (a T-junction). Triangles without area (three collinear corners) are passed over. At most `limit` pairs.
std::vector<std::array<int, 2>> self_intersections(const SimplicialComplex& complex,
                                                   std::size_t limit = 1'000'000);

}  // namespace aussois
