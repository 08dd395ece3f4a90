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

// Whether the same regions meet at two edges, which may then belong to one chain.
bool have_same_regions(const SimplicialComplex& k, const Idealisation& ideal, int edge, int other) {
  const auto region = [&](int t) { return ideal.triangle_region[t]; };
  return std::ranges::is_permutation(k.edge_triangles[edge], k.edge_triangles[other], {}, region, region);
}

void add_chain(std::span<const int> vertices, std::span<const int> edges, const Vec3& direction,
               Idealisation& out) {
  out.chains.push_back({.first = vertices.front(),
                        .last = vertices.back(),
                        .begin = int(out.path_edges.size()),
                        .edge_count = int(edges.size()),
                        .direction = direction});
  out.path_vertices.insert(out.path_vertices.end(), vertices.begin(), vertices.end());
  out.path_edges.insert(out.path_edges.end(), edges.begin(), edges.end());
}

// Cuts a polyline where it leaves the chord by more than the tolerance (Douglas and Peucker).
void split_straight(const SimplicialComplex& k, std::span<const int> vertices, std::span<const int> edges,
                    Idealisation& out) {
  std::vector<std::pair<std::size_t, std::size_t>> pieces = {{0, edges.size()}};  // the next one at the end
  while (!pieces.empty()) {
    const auto [first, last] = pieces.back();
    pieces.pop_back();
    const Vec3& a = k.vertices[vertices[first]];
    const Vec3 chord = k.vertices[vertices[last]] - a;
    const double length = chord.norm();
    std::size_t worst = first;
    double distance = out.tolerance;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Vec3 d = k.vertices[vertices[i]] - a;
      const double along = length > 0 ? std::clamp(d.dot(chord) / (length * length), 0.0, 1.0) : 0;
      const double off = (d - along * chord).norm();
      if (off > distance) distance = off, worst = i;
    }
    if (worst != first)
      pieces.insert(pieces.end(), {{worst, last}, {first, worst}});
    else if (length > 0)
      add_chain(vertices.subspan(first, last - first + 1), edges.subspan(first, last - first), chord / length,
                out);
  }
}

// The chain of each edge, and those that end at each vertex.
void list_chains(const SimplicialComplex& k, Idealisation& out) {
  out.edge_chain.assign(k.edges.size(), -1);
  std::vector<std::vector<int>> ends(k.vertices.size());
  for (std::size_t c = 0; c < out.chains.size(); ++c) {
    for (int e : edges_of(out, out.chains[c])) out.edge_chain[e] = int(c);
    ends[out.chains[c].first].push_back(int(c));
    if (out.chains[c].last != out.chains[c].first) ends[out.chains[c].last].push_back(int(c));
  }
  std::vector<int> begin = {0}, items;
  for (const auto& list : ends) {
    items.insert(items.end(), list.begin(), list.end());
    begin.push_back(int(items.size()));
  }
  out.vertex_chains = {std::move(begin), std::move(items)};
}

void trace_chains(const SimplicialComplex& k, Idealisation& out) {
  const auto edge_count = k.edges.size();
  struct Ends {  // of border edges at a vertex
    int count = 0;
    std::array<int, 2> first{};
  };
  std::vector<Ends> at(k.vertices.size());
  std::vector<char> border(edge_count);
  for (std::size_t e = 0; e < edge_count; ++e) {
    const auto around = k.edge_triangles[int(e)];
    border[e] = !(around.size() == 2 && out.triangle_region[around[0]] == out.triangle_region[around[1]]);
    if (border[e])
      for (int v : k.edges[e])
        if (Ends& ends = at[v]; ends.count++ < 2) ends.first[std::size_t(ends.count) - 1] = int(e);
  }
  const auto passes = [&](int v) {
    const auto& [count, e] = at[v];
    return count == 2 && have_same_regions(k, out, e[0], e[1]);
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
      const auto& two = at[v].first;
      e = two[0] == e ? two[1] : two[0];
      if (done[e]) break;
    }
    split_straight(k, vertices, edges, out);
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
  std::vector<Vec3> vertices = complex.vertices.to_vector();
  for (std::size_t c = 0; c < ideal.chains.size(); ++c) {
    const Chain& chain = ideal.chains[c];
    const Vec3 a = vertices[chain.first];
    const double length = (vertices[chain.last] - a).norm();
    const std::span<const int> path = vertices_of(ideal, int(c));
    for (const int v : path.subspan(1, path.size() - 2)) {
      Vec3& x = vertices[v];
      const Vec3 on_chord = a + std::clamp(chain.direction.dot(x - a), 0.0, length) * chain.direction;
      if ((x - on_chord).norm() <= foot) continue;
      moved.push_back({v, x});
      x = on_chord;
    }
  }
  if (!moved.empty()) complex.vertices = std::move(vertices);
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
    for (const int t : complex.edge_triangles[edges_of(ideal, chain).front()]) {
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
    add_chain(std::array{a, b}, std::array{e}, d.isZero(0) ? Vec3(Vec3::UnitX()) : Vec3(d.normalized()), out);
  }
  list_chains(complex, out);
  return out;
}

}  // namespace aussois
