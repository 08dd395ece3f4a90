// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "geometry/box_tree.hpp"
#include "geometry/repair_steps.hpp"

namespace aussois {
namespace {

using Edge = std::array<int, 2>;
using Triangle = std::array<int, 3>;

// A vertex on an open edge.
struct OnEdge {
  int edge = 0;
  double s = 0;  // from the lower vertex of the edge (0) to the higher (1)
  int vertex = 0;
  double distance = 0;                              // from the edge [m]
  auto operator<=>(const OnEdge&) const = default;  // NOLINT(modernize-use-nullptr): false alarm
};

struct Segment {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
};

// True if the segment passes the box enlarged by `distance` (slabs).
bool passes(const Segment& segment, const Box& box, double distance) {
  double enter = 0, leave = 1;
  for (int k = 0; k < 3; ++k) {
    const double lo = box.lo[k] - distance - segment.a[k], hi = box.hi[k] + distance - segment.a[k];
    const double d = segment.b[k] - segment.a[k];
    if (d == 0) {
      if (lo > 0 || hi < 0) return false;
    } else {
      enter = std::max(enter, std::min(lo / d, hi / d));
      leave = std::min(leave, std::max(lo / d, hi / d));
    }
  }
  return enter <= leave;
}

// Edges of the boundary modulo two (CPX-10).
std::vector<int> open_edges(const SimplicialComplex& complex) {
  std::vector<int> open;
  for (int e = 0; e < int(complex.edges.size()); ++e)
    if (complex.edge_triangles[e].size() % 2 == 1) open.push_back(e);
  return open;
}

bool on_a_triangle_at(const SimplicialComplex& complex, int edge, int vertex) {
  return std::ranges::any_of(complex.edge_triangles[edge],
                             [&](int t) { return std::ranges::count(complex.triangles[t], vertex) > 0; });
}

// The vertices of open edges that lie on open edges, sorted along each; none if there are so many of them
// that this is no surface with T-junctions.
std::vector<OnEdge> candidates(const SimplicialComplex& complex, const std::vector<int>& open,
                               double tolerance) {
  const std::size_t most = 1000 + 16 * open.size();
  std::vector<int> vertices;
  for (const int e : open)
    for (const int end : complex.edges[e]) vertices.push_back(end);
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Box> boxes(complex.vertices.size());
  for (const int v : vertices) boxes[v] = {complex.vertices[v], complex.vertices[v]};
  const BoxTree tree(std::move(boxes), std::move(vertices));

  std::vector<OnEdge> found;
  for (const int e : open) {
    const auto& ends = complex.edges[e];
    const Segment segment{complex.vertices[ends[0]], complex.vertices[ends[1]]};
    const Vec3 d = segment.b - segment.a;
    const double length = d.stableNorm();
    tree.for_each([&](const Box& box) { return passes(segment, box, tolerance); },
                  [&](int v) {
                    if (v == ends[0] || v == ends[1] || found.size() > most) return;
                    const Vec3 to_v = complex.vertices[v] - segment.a;
                    const double s = to_v.dot(d / length) / length;
                    const double distance = (to_v - s * d).norm();
                    if (s > 0 && s < 1 && distance <= tolerance && !on_a_triangle_at(complex, e, v))
                      found.push_back({e, s, v, distance});
                  });
    if (found.size() > most) return {};
  }
  std::ranges::sort(found);
  return found;
}

// Calls f(e, begin, end) for each open edge with its part of the sorted list.
template <class F>
void for_each_edge(const std::vector<int>& open, const std::vector<OnEdge>& on, const F& f) {
  std::size_t end = 0;
  for (const int e : open) {
    const std::size_t begin = end;
    while (end < on.size() && on[end].edge == e) ++end;
    f(e, begin, end);
  }
}

// Those of the candidates that end a piece which a second open edge has too (CPX-11).
std::vector<OnEdge> meeting(const SimplicialComplex& complex, const std::vector<int>& open,
                            const std::vector<OnEdge>& on) {
  struct Piece {
    Edge ends{};
    std::size_t before = 0;  // the candidate that ends it; before - 1 is the one that begins it
    int edge = 0;
  };
  std::vector<Piece> pieces;
  for_each_edge(open, on, [&](int e, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i <= end; ++i) {
      const int p = i == begin ? complex.edges[e][0] : on[i - 1].vertex;
      const int q = i == end ? complex.edges[e][1] : on[i].vertex;
      pieces.push_back({{std::min(p, q), std::max(p, q)}, i, e});
    }
  });
  std::ranges::sort(pieces, [](const Piece& a, const Piece& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.edge < b.edge;
  });
  std::vector<bool> keep(on.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool met = (i > 0 && pieces[i - 1].ends == pieces[i].ends) ||
                     (i + 1 < pieces.size() && pieces[i + 1].ends == pieces[i].ends);
    if (!met) continue;
    const std::size_t before = pieces[i].before;
    if (before < on.size() && on[before].edge == pieces[i].edge) keep[before] = true;
    if (before > 0 && on[before - 1].edge == pieces[i].edge) keep[before - 1] = true;
  }
  std::vector<OnEdge> kept;
  for (std::size_t i = 0; i < on.size(); ++i)
    if (keep[i]) kept.push_back(on[i]);
  return kept;
}

using Inserted = std::array<std::vector<int>, 3>;  // vertices on side k, from corner k to corner k + 1

// The pieces of a triangle whose sides carry vertices: a fan over the first such side; its outer pieces hand
// on what lies on the other two.
void cut(const Triangle& corners, const Inserted& on, std::vector<Triangle>& pieces) {
  std::size_t k = 0;
  while (k < 3 && on[k].empty()) ++k;
  if (k == 3) {
    pieces.push_back(corners);
    return;
  }
  const int apex = corners[(k + 2) % 3];
  int from = corners[k];
  for (std::size_t i = 0; i <= on[k].size(); ++i) {
    const bool first = i == 0, last = i == on[k].size();
    const int to = last ? corners[(k + 1) % 3] : on[k][i];
    cut({from, to, apex},
        {{{}, last ? on[(k + 1) % 3] : std::vector<int>{}, first ? on[(k + 2) % 3] : std::vector<int>{}}},
        pieces);
    from = to;
  }
}

// What lies on the sides of triangle t, in its own direction.
Inserted on_sides(const SimplicialComplex& complex, int t, const std::vector<std::vector<int>>& on_edge) {
  Inserted on;
  for (std::size_t k = 0; k < 3; ++k) {
    const int e = complex.triangle_edges[t][k];
    on[k] = on_edge[e];
    if (complex.triangles[t][k] != complex.edges[e][0]) std::ranges::reverse(on[k]);
  }
  return on;
}

// A vertex near a sharp corner may lie on two sides of a triangle; it is then inserted into neither.
void drop_ambiguous(const SimplicialComplex& complex, std::vector<OnEdge>& on) {
  std::vector<std::array<int, 3>> uses;  // triangle, vertex, edge
  for (const OnEdge& o : on)
    for (const int t : complex.edge_triangles[o.edge]) uses.push_back({t, o.vertex, o.edge});
  std::ranges::sort(uses);
  std::vector<Edge> ambiguous;  // edge, vertex
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i][0] != uses[i - 1][0] || uses[i][1] != uses[i - 1][1]) continue;
    ambiguous.push_back({uses[i - 1][2], uses[i][1]});
    ambiguous.push_back({uses[i][2], uses[i][1]});
  }
  std::ranges::sort(ambiguous);
  std::erase_if(on, [&](const OnEdge& o) {
    return std::ranges::binary_search(ambiguous, Edge{o.edge, o.vertex});
  });
}

}  // namespace

SplitComplex split_t_junctions(const SimplicialComplex& complex, double tolerance) {
  SplitComplex out;
  const std::vector<int> open = open_edges(complex);
  std::vector<OnEdge> on = meeting(complex, open, candidates(complex, open, tolerance));
  drop_ambiguous(complex, on);
  if (on.empty()) {
    out.complex = complex;
    return out;
  }
  std::vector<std::vector<int>> on_edge(complex.edges.size());
  for (const OnEdge& o : on) {
    on_edge[o.edge].push_back(o.vertex);
    out.inserted.add(complex.vertices[o.vertex], o.distance);
  }
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    cut(complex.triangles[t], on_sides(complex, int(t), on_edge), triangles);
  out.complex = make_complex(complex.vertices, std::move(triangles), wires_of(complex));
  return out;
}

}  // namespace aussois
