// SPDX-License-Identifier: Apache-2.0
#include "lmd/star_cones.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace aussois {
namespace {

const Vec3& at(const SimplicialComplex& k, int v) {
  return k.vertices[v];
}

Vec3 in_plane(const Vec3& d, const Vec3& n) {
  return d - n.dot(d) * n;
}

// Signed regions of the triangles on the first edge of a chain, and their conormals.
void conormals_of(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain,
                  std::vector<int>& signed_regions, std::vector<Vec3>& conormals) {
  const std::array<int, 2> ends = k.edges[edges_of(ideal, chain).front()];
  const int a = chain.first, b = ends[0] == a ? ends[1] : ends[0];
  for (int t : k.edge_triangles[edges_of(ideal, chain).front()]) {
    const auto& v = k.triangles[t];
    double sense = -ideal.triangle_sign[t];
    for (std::size_t i = 0; i < 3; ++i)
      if (v[i] == a && v[(i + 1) % 3] == b) sense = -sense;
    const int region = ideal.triangle_region[t];
    signed_regions.push_back(sense > 0 ? region + 1 : -(region + 1));
    conormals.push_back(sense * ideal.region_normal[region].cross(chain.direction).normalized());
  }
}

// Shapes that deform have every vertex and every edge as a leaf, also where they are flat or hollow by up to
// kHollow: their points bear what touches there (DEF-5). Such a star is made to fall off by kFall all around.
constexpr double kHollow = 0.15;  // sine of the angle
constexpr double kFall = 1e-4;

// The unit directions of a star seen from its side n, those that do not fall off bent down; nothing if it is
// hollow.
std::optional<std::vector<Vec3>> falling(const std::vector<Vec3>& star, const Vec3& n) {
  std::vector<Vec3> out;
  for (const Vec3& d : star) {
    const double rise = n.dot(d);
    if (rise > kHollow) return std::nullopt;
    out.push_back(rise > -kFall ? Vec3(in_plane(d, n).normalized() - kFall * n) : d);
  }
  return out;
}
bool falls(const std::vector<Vec3>& star, const Vec3& n) {
  return std::ranges::all_of(star, [&](const Vec3& d) { return n.dot(d) <= -kFall; });
}

// Makes those of a star that go on nearly straight, in pairs for which `may`(sum of their directions) holds,
// do so exactly, the straightest pair first. False if none does.
bool straighten(std::vector<Vec3>& star, const auto& may) {
  struct Bend {
    double size;
    std::size_t i, j;
  };
  std::vector<Bend> bends;
  for (std::size_t i = 0; i < star.size(); ++i)
    for (std::size_t j = i + 1; j < star.size(); ++j) {
      const Vec3 sum = star[i] + star[j];
      if (const double bend = sum.norm(); bend <= 2 * kHollow && may(sum)) bends.push_back({bend, i, j});
    }
  std::ranges::stable_sort(bends, {}, &Bend::size);
  std::vector<char> goes_on(star.size(), 0);
  for (const Bend& bend : bends) {
    if (goes_on[bend.i] || goes_on[bend.j]) continue;
    goes_on[bend.i] = goes_on[bend.j] = 1;
    star[bend.i] = (star[bend.i] - star[bend.j]).normalized();
    star[bend.j] = -star[bend.i];
  }
  return !bends.empty();
}

// Of a vertex of wires; nothing if none goes on nearly straight.
std::optional<NormalCone> cone_of_wires(std::vector<Vec3> star) {
  if (!straighten(star, [](const Vec3&) { return true; })) return std::nullopt;
  NormalCone cone = make_normal_cone(star);  // for its cap
  if (cone.lineality == 3) return std::nullopt;
  cone.lineality = 0, cone.cyclic = false;
  cone.rays = std::move(star);
  return cone;
}

Vec3 mean_normal(const SimplicialComplex& k, std::span<const int> triangles) {
  Vec3 sum = Vec3::Zero();
  for (const int t : triangles) {
    const auto& v = k.triangles[t];
    sum += (at(k, v[1]) - at(k, v[0])).cross(at(k, v[2]) - at(k, v[0]));
  }
  return sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::UnitZ());
}

}  // namespace

ChainCone chain_cone(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  std::vector<int> sides;
  std::vector<Vec3> conormals;
  conormals_of(k, ideal, chain, sides, conormals);
  ChainCone out;
  if (k.solid) {  // interior side: a concave crease has the whole space as tangent cone's hull
    const int t = k.edge_triangles[edges_of(ideal, chain).front()][0];
    const Vec3 n = ideal.triangle_sign[t] * ideal.region_normal[ideal.triangle_region[t]];
    out.rise = n.dot(conormals[1]);
    if (out.rise >= -1e-12) return out;  // concave or flat: N = {0}
  }
  const NormalCone cone = edge_cone(chain.direction, conormals);
  if (cone.lineality != 1) return out;
  out.simplex_class = cone.rays.size() == 2 ? SimplexClass::e_crease : SimplexClass::e_wide;
  out.axis = cone.axis;
  out.half_angle = cone.half_angle;
  for (std::size_t i = 0; i < cone.rays.size(); ++i) {  // the conormal that each extreme ray is
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < conormals.size(); ++j)
      if (cone.rays[i].dot(conormals[j]) > cone.rays[i].dot(conormals[nearest])) nearest = j;
    out.conormals[i] = sides[nearest];
  }
  return out;
}

std::vector<Vec3> vertex_directions(const SimplicialComplex& k, const Idealisation& ideal, int v) {
  std::vector<Vec3> directions;
  for (int c : ideal.vertex_chains[v]) {
    const Chain& chain = ideal.chains[c];
    if (chain.first == v) directions.push_back(chain.direction);
    if (chain.last == v) directions.push_back(-chain.direction);
  }
  for (int t : k.vertex_triangles[v]) {
    const Vec3& n = ideal.region_normal[ideal.triangle_region[t]];
    for (int e : k.triangle_edges[t]) {
      const auto& ends = k.edges[e];
      if ((ends[0] != v && ends[1] != v) || ideal.edge_chain[e] >= 0) continue;
      const Vec3 d = in_plane(at(k, ends[0] == v ? ends[1] : ends[0]) - at(k, v), n);
      if (d.norm() > 10 * ideal.tolerance) directions.push_back(d);
    }
  }
  return directions;
}

bool is_pit(const Idealisation& ideal, const std::vector<ChainCone>& cones, const NormalCone& cone, int v) {
  double sharpest = 0;
  for (int c : ideal.vertex_chains[v]) {
    const Chain& chain = ideal.chains[c];
    const Vec3 d = chain.first == v ? chain.direction : Vec3(-chain.direction);
    const bool extreme = std::ranges::any_of(cone.rays, [&](const Vec3& g) { return (g - d).norm() < 1e-6; });
    const double rise = cones[c].rise;
    if (extreme && std::abs(rise) > std::abs(sharpest)) sharpest = rise;
  }
  return sharpest > 0;
}

bool is_blunt(const NormalCone& cone) {
  return cone.rays.size() >= 2 && cone.depth < kFall;
}

std::vector<NormalCone> soft_cones(const SimplicialComplex& k, const Idealisation& ideal, int v,
                                   bool has_own) {
  std::vector<NormalCone> out;
  if (k.solid && has_own) return out;
  std::vector<Vec3> star = vertex_directions(k, ideal, v);
  for (Vec3& d : star) d.normalize();
  if (k.vertex_triangles[v].empty()) {
    if (auto cone = cone_of_wires(std::move(star))) out.push_back(std::move(*cone));
    return out;
  }
  const Vec3 n = mean_normal(k, k.vertex_triangles[v]);
  for (const double side : {1.0, -1.0}) {
    if (side < 0 && k.solid) break;
    if (has_own && falls(star, side * n)) continue;
    std::vector<Vec3> smooth = star;
    straighten(smooth, [&](const Vec3& sum) { return side * n.dot(sum) > -kFall; });
    if (const auto bent = falling(smooth, side * n))
      if (NormalCone cone = make_normal_cone(*bent); cone.lineality == 0 && cone.rays.size() >= 3)
        out.push_back(std::move(cone));
  }
  return out;
}

std::vector<SoftEdge> soft_edges(const SimplicialComplex& k, const Idealisation& ideal,
                                 const std::vector<ChainCone>& cones) {
  std::vector<SoftEdge> out;
  for (int c = 0; c < int(cones.size()); ++c) {
    const Chain& chain = ideal.chains[std::size_t(c)];
    const std::span<const int> sides = k.edge_triangles[edges_of(ideal, chain).front()];
    const bool has_own = bool(cones[std::size_t(c)].simplex_class);
    if (sides.size() != 2 || (k.solid && has_own)) continue;
    std::vector<int> regions;
    std::vector<Vec3> conormals;
    conormals_of(k, ideal, chain, regions, conormals);
    const Vec3 n = in_plane(mean_normal(k, sides), chain.direction).normalized();
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && k.solid) break;
      if (has_own && falls(conormals, side * n)) continue;
      const auto bent = falling(conormals, side * n);
      if (!bent || !n.allFinite()) continue;
      SoftEdge edge{.chain = c};
      for (std::size_t i = 0; i < 2; ++i) edge.normals[i] = chain.direction.cross((*bent)[i].normalized());
      const NormalCone cone =
          edge_cone(chain.direction, std::array{(*bent)[0].normalized(), (*bent)[1].normalized()});
      edge.axis = cone.axis, edge.half_angle = cone.half_angle;
      out.push_back(edge);
    }
  }
  return out;
}

}  // namespace aussois
