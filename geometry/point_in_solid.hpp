// SPDX-License-Identifier: Apache-2.0
// Tells whether a point is inside a solid, that is, whether the surface goes round it (CPX-13). Exact
// arithmetic decides, also for vertices, edges and faces right above the point, for slivers and for distances
// next to nothing.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// The connected pieces of a complex: simplices that share a vertex belong together; an isolated vertex is a
/// piece of its own. Pieces are numbered in the order of their lowest vertices.
struct Pieces {
  std::vector<int> of_vertex{};  // the piece of every vertex
  std::vector<int> vertex{};     // the lowest vertex of every piece
  std::vector<Box> box{};        // of every piece
};
Pieces connected_pieces(const SimplicialComplex& complex);

/// How the half-line from p along z crosses a triangle: 1 from behind, -1 from the front, 0 not at all. The
/// sum over a closed oriented surface that p does not lie on is how often the surface goes round p (CPX-13).
int crossing_sign(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// A point in the cavity of a hollow solid is outside. `pieces` are the solid's. Meaningless if the complex
/// is not a solid, and for points on its surface. O(triangles).
bool is_inside(const SimplicialComplex& solid, const Pieces& pieces, const Vec3& p);

}  // namespace aussois
