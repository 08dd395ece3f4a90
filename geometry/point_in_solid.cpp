// SPDX-License-Identifier: Apache-2.0
#include "geometry/point_in_solid.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/exact_point.hpp"

namespace aussois {
namespace {

ExactKernel::Point_2 flat(const Vec3& x) {
  return {x.x(), x.y()};
}

}  // namespace

Pieces connected_pieces(const SimplicialComplex& complex) {
  std::vector<int> parent(complex.vertices.size());  // never above its vertex: roots are the lowest of pieces
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b] : complex.edges) {
    const int i = root(a), j = root(b);
    parent[std::max(i, j)] = std::min(i, j);
  }
  Pieces out;
  out.of_vertex.resize(parent.size());
  for (int v = 0; v < int(parent.size()); ++v) {
    const int first = root(v);
    if (first == v) {
      out.of_vertex[v] = int(out.vertex.size());
      out.vertex.push_back(v);
      out.box.emplace_back();
    } else {
      out.of_vertex[v] = out.of_vertex[first];
    }
    const Vec3& x = complex.vertices[v];
    Box& box = out.box[out.of_vertex[v]];
    box.lo = box.lo.cwiseMin(x), box.hi = box.hi.cwiseMax(x);
  }
  return out;
}

// Seen along z: how often the triangle goes round p, counted on the half-line from p along x. An edge that p
// lies on, or an end of it, is on one side for both of its triangles, so none is crossed twice or never.
int crossing_sign(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (std::max({a.z(), b.z(), c.z()}) <= p.z()) return 0;
  int turns = 0;
  for (const auto& [u, v] : {std::pair(&a, &b), std::pair(&b, &c), std::pair(&c, &a)}) {
    const bool from_below = u->y() <= p.y(), to_below = v->y() <= p.y();
    if (from_below == to_below || std::max(u->x(), v->x()) <= p.x()) continue;
    const Vec3 &lower = from_below ? *u : *v, &upper = from_below ? *v : *u;
    if (std::min(u->x(), v->x()) > p.x() ||
        CGAL::orientation(flat(lower), flat(upper), flat(p)) == CGAL::LEFT_TURN)
      turns += from_below ? 1 : -1;
  }
  if (turns == 0) return 0;
  const CGAL::Orientation side = CGAL::orientation(exact(a), exact(b), exact(c), exact(p));
  return int(side) * turns < 0 ? turns : 0;  // above p
}

bool is_inside(const SimplicialComplex& solid, const Pieces& pieces, const Vec3& p) {
  std::vector<char> counts;  // pieces whose box holds the point: the others do not go round it
  counts.reserve(pieces.box.size());
  bool any = false;
  for (const Box& box : pieces.box) {
    counts.push_back((box.lo.array() <= p.array()).all() && (p.array() <= box.hi.array()).all());
    any = any || counts.back();
  }
  if (!any) return false;
  int turns = 0;
  for (const auto& [i, j, k] : solid.triangles)
    if (counts[pieces.of_vertex[i]])
      turns += crossing_sign(p, solid.vertices[i], solid.vertices[j], solid.vertices[k]);
  return turns > 0;  // (CPX-13)
}

}  // namespace aussois
