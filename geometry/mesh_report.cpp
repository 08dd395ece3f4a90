// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh_report.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "geometry/number_text.hpp"
#include "geometry/point_in_solid.hpp"
#include "geometry/self_intersections.hpp"

namespace aussois {
namespace {

constexpr double kDegenerate = 1e-12;  // of the diagonal: some 10^4 roundings of a coordinate

void measure_triangles(const SimplicialComplex& complex, MeshReport& report) {
  const double diagonal = report.box.diagonal();
  double smallest = kInf;
  for (const auto& [a, b, c] : complex.triangles) {
    const double h = triangle_height(complex.vertices[a], complex.vertices[b], complex.vertices[c]);
    report.degenerate_triangles += h <= kDegenerate * diagonal;
    smallest = std::min(smallest, h);
  }
  report.min_height_ratio = smallest < kInf && diagonal > 0 ? smallest / diagonal : 0;
}

void count_edges(const SimplicialComplex& complex, MeshReport& report) {
  for (int e = 0; e < report.edges; ++e) {
    const std::span<const int> around = complex.edge_triangles[e];
    report.wire_edges += around.empty();
    report.border_edges += around.size() == 1;
    report.non_manifold_edges += around.size() > 2;
    report.misoriented_edges +=
        around.size() == 2 && runs_upwards(complex, around[0], e) == runs_upwards(complex, around[1], e);
  }
}

// A fan: triangles around a vertex that are joined by edges at this vertex.
void count_vertices(const SimplicialComplex& complex, MeshReport& report) {
  std::vector<int> reached_at(complex.triangles.size(), -1);  // the vertex at which a triangle was seen last
  std::vector<int> front;
  for (int v = 0; v < report.vertices; ++v) {
    report.isolated_vertices += complex.vertex_edges[v].empty();
    int fans = 0;
    for (const int first : complex.vertex_triangles[v]) {
      if (reached_at[first] == v) continue;
      ++fans;
      front = {first};
      reached_at[first] = v;
      while (!front.empty()) {
        const int t = front.back();
        front.pop_back();
        for (const int e : complex.triangle_edges[t]) {
          const auto& ends = complex.edges[e];
          if (ends[0] != v && ends[1] != v) continue;
          for (const int other : complex.edge_triangles[e]) {
            if (reached_at[other] == v) continue;
            reached_at[other] = v;
            front.push_back(other);
          }
        }
      }
    }
    report.non_manifold_vertices += fans > 1;
  }
}

int count_duplicate_vertices(const SimplicialComplex& complex) {
  const std::vector<int> first = first_at_same_place(complex.vertices);
  int count = 0;
  for (std::size_t i = 0; i < first.size(); ++i) count += first[i] != int(i);
  return count;
}

int count_duplicate_triangles(const SimplicialComplex& complex) {
  std::vector<std::array<int, 3>> sorted = complex.triangles.to_vector();
  for (auto& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  return int(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

}  // namespace

double triangle_height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = c - b;
  const double longest = std::max({u.stableNorm(), v.stableNorm(), w.stableNorm()});
  // The sides are divided by the longest first, so that no size under- or overflows.
  return longest > 0 ? longest * (u / longest).cross(v / longest).norm() : 0;
}

std::vector<int> first_at_same_place(std::span<const Vec3> vertices) {
  const auto at = [&](int i) -> const Vec3& { return vertices[i]; };
  std::vector<int> order(vertices.size());  // equal places side by side, the earliest vertex first
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    for (int k = 0; k < 3; ++k)
      if (at(i)[k] != at(j)[k]) return at(i)[k] < at(j)[k];
    return i < j;
  });
  std::vector<int> first(vertices.size());
  int leader = -1;
  for (const int i : order) {
    if (leader < 0 || at(i) != at(leader)) leader = i;
    first[i] = leader;
  }
  return first;
}

MeshReport report_mesh(const SimplicialComplex& complex) {
  MeshReport report;
  report.vertices = int(complex.vertices.size());
  report.edges = int(complex.edges.size());
  report.triangles = int(complex.triangles.size());
  report.box = bounding_box(complex);
  report.components = int(connected_pieces(complex).vertex.size());
  measure_triangles(complex, report);
  count_edges(complex, report);
  count_vertices(complex, report);
  report.duplicate_vertices = count_duplicate_vertices(complex);
  report.duplicate_triangles = count_duplicate_triangles(complex);
  report.self_intersections = int(self_intersections(complex).size());

  const bool any = report.triangles > 0;
  report.closed = any && report.wire_edges + report.border_edges + report.non_manifold_edges == 0;
  report.oriented = any && report.misoriented_edges + report.non_manifold_edges == 0;
  report.manifold = any && report.wire_edges + report.isolated_vertices + report.non_manifold_edges +
                                   report.non_manifold_vertices ==
                               0;
  if (report.closed && report.oriented) report.volume = signed_volume(complex);
  return report;
}

std::string to_string(const MeshReport& report) {
  std::string text;
  char line[256];
  const auto say = [&](const char* format, auto... values) {
    std::snprintf(line, sizeof line, format, values...);
    text += line;
  };
  text += counted_noun(report.vertices, "vertex", "vertices") + ", " + counted_noun(report.edges, "edge") +
          ", " + counted_noun(report.triangles, "triangle") + ", " +
          counted_noun(report.components, "component") + "\n";
  if (report.vertices > 0) {
    const Vec3 size = 1e3 * (report.box.hi - report.box.lo);
    const Vec3 lo = 1e3 * report.box.lo, hi = 1e3 * report.box.hi;
    say("box %.6g x %.6g x %.6g mm, from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) mm\n", size.x(), size.y(),
        size.z(), lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z());
  }
  if (report.triangles > 0) {
    say("%s, %s, %s\n", report.closed ? "closed" : "open", report.oriented ? "oriented" : "not oriented",
        report.manifold ? "manifold" : "not manifold");
    if (report.closed && report.oriented)
      say("volume %.6g m^3%s\n", report.volume, report.volume > 0 ? "" : ": the triangles face inwards");
    say("smallest triangle height %.3g m, %.3g of the box diagonal\n",
        report.min_height_ratio * report.box.diagonal(), report.min_height_ratio);
  }
  const auto count = [&](int value, const char* one, const char* many = "") {
    if (value > 0) text += counted_noun(value, one, many) + "\n";
  };
  count(report.isolated_vertices, "isolated vertex", "isolated vertices");
  count(report.wire_edges, "edge without a triangle", "edges without a triangle");
  count(report.border_edges, "border edge");
  count(report.non_manifold_edges, "edge with three or more triangles", "edges with three or more triangles");
  count(report.non_manifold_vertices, "vertex with more than one fan of triangles",
        "vertices with more than one fan of triangles");
  count(report.misoriented_edges, "edge between triangles of opposite orientation",
        "edges between triangles of opposite orientation");
  count(report.degenerate_triangles, "degenerate triangle");
  count(report.duplicate_vertices, "duplicate vertex", "duplicate vertices");
  count(report.duplicate_triangles, "duplicate triangle");
  count(report.self_intersections, "pair of intersecting triangles", "pairs of intersecting triangles");
  return text;
}

}  // namespace aussois
