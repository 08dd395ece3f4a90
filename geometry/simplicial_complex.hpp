// SPDX-License-Identifier: Apache-2.0
// The simplicial complex: points, edges and triangles of mixed dimension with their incidences (CPX-1),
// (CPX-2). |K| is the disjoint union of the open simplices. A *solid* is a closed oriented triangle surface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/se3.hpp"
#include "geometry/shared_array.hpp"

namespace aussois {

/// Compressed rows: the items of row i are items[begin[i]] ... items[begin[i + 1] - 1], ascending.
struct Incidence {
  SharedArray<int> begin{};
  SharedArray<int> items{};
  std::span<const int> operator[](int row) const {
    return {items.data() + begin[row], items.data() + begin[std::size_t(row) + 1]};
  }
};

struct SimplicialComplex {
  SharedArray<Vec3> vertices{};  // [m], in the frame of the mesh
  SharedArray<std::array<int, 2>>
      edges{};  // all edges, those of triangles included; ascending indices, sorted
  SharedArray<std::array<int, 3>> triangles{};  // counter-clockwise seen from outside, in the order given
  SharedArray<std::array<int, 3>> triangle_edges{};  // edge k of a triangle joins its corners k and k + 1
  Incidence edge_triangles{};                        // 0, 1, 2 or more triangles on an edge
  Incidence vertex_edges{};
  Incidence vertex_triangles{};
  bool solid = false;  // the triangles bound a volume and face outwards; otherwise they are two-sided sheets
};

/// Builds edges and incidences from triangles, wires (edges without triangles) and points (vertices alone).
/// Throws std::invalid_argument naming the first simplex with an index out of range, a repeated vertex, or a
/// coordinate that is not finite. `solid` is the caller's claim, and it is checked: every edge must have two
/// triangles with opposite orientation (the message counts the offending edges), and the enclosed volume must
/// be positive; otherwise throws std::invalid_argument. A wire given twice, or along a triangle, is one edge;
/// triangles and vertices are kept as given, in order. O(n log n).
SimplicialComplex make_complex(SharedArray<Vec3> vertices, SharedArray<std::array<int, 3>> triangles,
                               const SharedArray<std::array<int, 2>>& wires = {}, bool solid = false);

/// True if triangle t traverses its edge e from the lower to the higher vertex.
bool runs_upwards(const SimplicialComplex& complex, int t, int e);

/// True if there are triangles and every edge has exactly two of them, traversed in opposite directions.
bool is_closed_oriented(const SimplicialComplex& complex);

/// Sum of the signed tetrahedra between the triangles and the first vertex (CPX-4) [m^3]: the enclosed volume
/// if the triangles are closed and oriented, positive when they face outwards; meaningless otherwise.
double signed_volume(const SimplicialComplex& complex);

/// Largest distance of a vertex from `centre` [m].
double radius_about(const SimplicialComplex& complex, const Vec3& centre);

struct Box {
  Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);  // [m]
  double diagonal() const { return (hi - lo).norm(); }
};
Box bounding_box(const SimplicialComplex& complex);

/// The same complex with vertices g * (scale * x). Throws std::invalid_argument unless 0 < scale < inf.
SimplicialComplex transformed_complex(const SimplicialComplex& complex, const SE3& g, double scale = 1.0);

}  // namespace aussois
