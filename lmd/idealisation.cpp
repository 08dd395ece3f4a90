// SPDX-License-Identifier: Apache-2.0
#include "lmd/idealisation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace aussois {
namespace {

Vec3 area_vector(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[t];
  const Vec3 &x = k.vertices[a], &y = k.vertices[b], &z = k.vertices[c];
  return (y - x).cross(z - x) / 2;
}

double longest_side(const SimplicialComplex& k, int t) {
  const auto& v = k.triangles[t];
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    longest = std::max(longest, (k.vertices[v[i]] - k.vertices[v[(i + 1) % 3]]).norm());
  return longest;
}

// +1 if triangle t runs through the edge from its smaller to its larger vertex, -1 the other way.
int sense(const SimplicialComplex& k, int t, int edge) {
  const auto& v = k.triangles[t];
  const auto& e = k.edges[edge];
  for (std::size_t i = 0; i < 3; ++i)
    if (v[i] == e[0] && v[(i + 1) % 3] == e[1]) return 1;
  return -1;
}

void grow_regions(const SimplicialComplex& k, Idealisation& out) {
  const int n = int(k.triangles.size());
  std::vector<double> area(static_cast<std::size_t>(n)), height(static_cast<std::size_t>(n));
  std::vector<Vec3> normal(static_cast<std::size_t>(n), Vec3::UnitZ());
  for (int t = 0; t < n; ++t) {
    const Vec3 a = area_vector(k, t);
    const auto i = std::size_t(t);
    area[i] = a.norm();
    height[i] = area[i] > 0 ? 2 * area[i] / longest_side(k, t) : 0;
    if (area[i] > 0) normal[i] = a / area[i];
  }
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](int a, int b) { return area[a] > area[b]; });

  constexpr double kCosOneDegree = 0.99984769515639127;
  out.triangle_region.assign(std::size_t(n), -1);
  out.triangle_sign.assign(std::size_t(n), 1);
  for (int seed : order) {
    if (out.triangle_region[seed] >= 0) continue;
    const int region = int(out.region_normal.size());
    const Vec3 plane = normal[seed];
    const double offset = plane.dot(k.vertices[k.triangles[seed][0]]);
    out.region_normal.push_back(plane);
    out.region_offset.push_back(offset);
    out.triangle_region[seed] = region;
    std::vector<int> front{seed};
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      for (int edge : k.triangle_edges[t]) {
        const auto both = k.edge_triangles[edge];
        if (both.size() != 2) continue;
        const int other = both[0] == t ? both[1] : both[0];
        const auto o = std::size_t(other);
        if (other == t || out.triangle_region[o] >= 0) continue;
        const bool coherent = sense(k, t, edge) != sense(k, other, edge);
        if (k.solid && !coherent) continue;
        const double sign = coherent ? out.triangle_sign[t] : -out.triangle_sign[t];
        const bool sliver = height[o] < 10 * out.tolerance;
        if (!sliver && sign * normal[o].dot(plane) < kCosOneDegree) continue;
        const bool flat = std::ranges::all_of(k.triangles[o], [&](int v) {
          return std::abs(plane.dot(k.vertices[v]) - offset) <= out.tolerance;
        });
        if (!flat) continue;
        out.triangle_region[o] = region;
        out.triangle_sign[o] = sign;
        front.push_back(other);
      }
    }
  }
}

// The regions on an edge, sorted; two edges with the same list may belong to one chain.
std::vector<int> regions_of(const SimplicialComplex& k, const Idealisation& ideal, int edge) {
  std::vector<int> regions;
  for (int t : k.edge_triangles[edge]) regions.push_back(ideal.triangle_region[t]);
  std::ranges::sort(regions);
  return regions;
}

// Cuts a polyline where it leaves the chord by more than the tolerance (Douglas and Peucker).
void split_straight(const SimplicialComplex& k, const std::vector<int>& vertices,
                    const std::vector<int>& edges, std::size_t first, std::size_t last, double tolerance,
                    std::vector<Chain>& out) {
  const Vec3& a = k.vertices[vertices[first]];
  const Vec3 chord = k.vertices[vertices[last]] - a;
  const double length = chord.norm();
  std::size_t worst = first;
  double distance = tolerance;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vec3 d = k.vertices[vertices[i]] - a;
    const double along = length > 0 ? std::clamp(d.dot(chord) / (length * length), 0.0, 1.0) : 0;
    const double off = (d - along * chord).norm();
    if (off > distance) distance = off, worst = i;
  }
  if (worst != first) {
    split_straight(k, vertices, edges, first, worst, tolerance, out);
    split_straight(k, vertices, edges, worst, last, tolerance, out);
    return;
  }
  if (length == 0) return;
  Chain chain;
  chain.first = vertices[first];
  chain.last = vertices[last];
  chain.vertices.assign(vertices.begin() + long(first), vertices.begin() + long(last) + 1);
  chain.edges.assign(edges.begin() + long(first), edges.begin() + long(last));
  chain.direction = chord / length;
  out.push_back(std::move(chain));
}

// The chain of each edge, and those that end at each vertex.
void list_chains(const SimplicialComplex& k, Idealisation& out) {
  out.edge_chain.assign(k.edges.size(), -1);
  std::vector<std::vector<int>> ends(k.vertices.size());
  for (std::size_t c = 0; c < out.chains.size(); ++c) {
    for (int e : out.chains[c].edges) out.edge_chain[e] = int(c);
    ends[out.chains[c].first].push_back(int(c));
    if (out.chains[c].last != out.chains[c].first) ends[out.chains[c].last].push_back(int(c));
  }
  out.vertex_chains.begin.assign(1, 0);
  for (const auto& list : ends) {
    out.vertex_chains.items.insert(out.vertex_chains.items.end(), list.begin(), list.end());
    out.vertex_chains.begin.push_back(int(out.vertex_chains.items.size()));
  }
}

void trace_chains(const SimplicialComplex& k, Idealisation& out) {
  const auto edge_count = k.edges.size();
  std::vector<std::vector<int>> regions(edge_count);
  std::vector<char> border(edge_count, 0);
  std::vector<std::vector<int>> at(k.vertices.size());  // border edges at a vertex
  for (std::size_t e = 0; e < edge_count; ++e) {
    regions[e] = regions_of(k, out, int(e));
    border[e] = !(regions[e].size() == 2 && regions[e][0] == regions[e][1]);
    if (border[e])
      for (int v : k.edges[e]) at[v].push_back(int(e));
  }
  const auto passes = [&](int v) {
    const auto& e = at[v];
    return e.size() == 2 && regions[e[0]] == regions[e[1]];
  };
  std::vector<char> done(edge_count, 0);
  const auto trace = [&](int edge, int from) {
    std::vector<int> vertices{from}, edges;
    for (int e = edge, v = from;;) {
      done[e] = 1;
      edges.push_back(e);
      const auto& ends = k.edges[e];
      v = ends[0] == v ? ends[1] : ends[0];
      vertices.push_back(v);
      if (!passes(v)) break;
      const auto& two = at[v];
      e = two[0] == e ? two[1] : two[0];
      if (done[e]) break;
    }
    split_straight(k, vertices, edges, 0, vertices.size() - 1, out.tolerance, out.chains);
  };
  for (std::size_t e = 0; e < edge_count; ++e)  // first the open ones, from their ends
    if (border[e] && !done[e])
      for (int v : k.edges[e])
        if (!done[e] && !passes(v)) trace(int(e), v);
  for (std::size_t e = 0; e < edge_count; ++e)  // then the loops
    if (border[e] && !done[e]) trace(int(e), k.edges[e][0]);

  list_chains(k, out);
}

}  // namespace

std::vector<MovedVertex> straighten_chains(SimplicialComplex& complex, const Idealisation& ideal,
                                           double foot) {
  std::vector<MovedVertex> moved;
  for (const Chain& chain : ideal.chains) {
    const Vec3 a = complex.vertices[chain.first];
    const double length = (complex.vertices[chain.last] - a).norm();
    for (std::size_t i = 1; i + 1 < chain.vertices.size(); ++i) {
      Vec3& x = complex.vertices[chain.vertices[i]];
      const Vec3 on_chord = a + std::clamp(chain.direction.dot(x - a), 0.0, length) * chain.direction;
      if ((x - on_chord).norm() <= foot) continue;
      moved.push_back({chain.vertices[i], x});
      x = on_chord;
    }
  }
  std::ranges::sort(moved, {}, &MovedVertex::vertex);
  return moved;
}

std::vector<double> misfit_at_vertices(const SimplicialComplex& complex, const Idealisation& ideal) {
  constexpr double kRounding = 1e-6;  // up to a distance of 1e-3 of the size, feet are forgiven as much
  std::vector<std::array<double, 2>> largest(complex.vertices.size(), {0, 0});
  const auto add = [&](int v, double sine) {
    auto& [first, second] = largest[v];
    second = std::max(second, std::min(first, sine));
    first = std::max(first, sine);
  };
  for (const Chain& chain : ideal.chains)
    for (const int t : complex.edge_triangles[chain.edges.front()]) {
      const auto region = std::size_t(ideal.triangle_region[t]);
      const double sine = std::abs(ideal.region_normal[region].dot(chain.direction));
      add(chain.first, sine);
      add(chain.last, sine);
    }
  std::vector<double> misfit;
  misfit.reserve(largest.size());
  for (const auto& [first, second] : largest)
    misfit.push_back(first + second > kRounding ? first + second : 0);
  return misfit;
}

Idealisation idealise(const SimplicialComplex& complex, double tolerance) {
  Idealisation out;
  out.tolerance = tolerance;
  grow_regions(complex, out);
  trace_chains(complex, out);
  return out;
}

Idealisation idealise_each(const SimplicialComplex& complex, double tolerance) {
  Idealisation out;
  out.tolerance = tolerance;
  for (int t = 0; t < int(complex.triangles.size()); ++t) {
    const Vec3 area = area_vector(complex, t);
    const Vec3 normal = area.isZero(0) ? Vec3(Vec3::UnitZ()) : Vec3(area.normalized());
    out.triangle_region.push_back(t);
    out.triangle_sign.push_back(1);
    out.region_normal.push_back(normal);
    out.region_offset.push_back(normal.dot(complex.vertices[complex.triangles[t][0]]));
  }
  for (int e = 0; e < int(complex.edges.size()); ++e) {
    const auto& [a, b] = complex.edges[e];
    const Vec3 d = complex.vertices[b] - complex.vertices[a];
    out.chains.push_back({.first = a,
                          .last = b,
                          .vertices = {a, b},
                          .edges = {e},
                          .direction = d.isZero(0) ? Vec3(Vec3::UnitX()) : Vec3(d.normalized())});
  }
  list_chains(complex, out);
  return out;
}

}  // namespace aussois
