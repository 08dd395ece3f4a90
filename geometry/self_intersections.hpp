// SPDX-License-Identifier: Apache-2.0
// Finds the triangles of a soup that pass through each other, by exact arithmetic.
#pragma once

#include <array>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// Pairs (i < j, ascending) of triangles that meet anywhere but in a vertex or edge they share. Coincident
/// vertices count as shared, so a surface with split vertices is judged like the welded one. Two triangles
/// with their corners at the same three places are a pair, and so are two that touch without sharing a vertex
/// there (a T-junction). Triangles without area (three collinear corners) are skipped. At most `limit` pairs.
std::vector<std::array<int, 2>> self_intersections(const SimplicialComplex& complex,
                                                   std::size_t limit = 1'000'000);

}  // namespace aussois
