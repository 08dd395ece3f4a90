// SPDX-License-Identifier: Apache-2.0
#include "lmd/lmd_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/check.hpp"

namespace aussois {
namespace {

const Vec3& at(const SimplicialComplex& k, int v) {
  return k.vertices[std::size_t(v)];
}

Vec3 in_plane(const Vec3& d, const Vec3& n) {
  return d - n.dot(d) * n;
}

// In-plane direction from edge (a, b) into triangle t, by the normal of its region.
Vec3 conormal_into(const SimplicialComplex& k, const Idealisation& ideal, int t, const Vec3& direction, int a,
                   int b) {
  const auto& v = k.triangles[std::size_t(t)];
  double sense = -1;
  for (std::size_t i = 0; i < 3; ++i)
    if (v[i] == a && v[(i + 1) % 3] == b) sense = 1;
  const Vec3& n = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(t)])];
  const Vec3 c = sense * ideal.triangle_sign[std::size_t(t)] * n.cross(direction);
  return c.normalized();
}

enum class Crease { convex, concave, other };

struct ChainCone {
  Crease crease = Crease::other;
  NormalCone cone{};
};

ChainCone chain_cone(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  const int edge = chain.edges.front();
  const int a = chain.vertices[0], b = chain.vertices[1];
  std::vector<Vec3> generators{chain.direction, -chain.direction};
  std::vector<Vec3> conormals;
  for (int t : k.edge_triangles[edge]) conormals.push_back(conormal_into(k, ideal, t, chain.direction, a, b));
  ChainCone out;
  if (k.solid) {  // interior side: a concave crease has the whole space as tangent cone's hull
    const int t = k.edge_triangles[edge][0];
    const Vec3 n = ideal.triangle_sign[std::size_t(t)] *
                   ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(t)])];
    const double rise = n.dot(conormals[1]);
    out.crease = rise < 0 ? Crease::convex : Crease::concave;
    if (rise >= -1e-12) return out;  // concave or flat: the default cone has N = {0}
  }
  generators.insert(generators.end(), conormals.begin(), conormals.end());
  out.cone = make_normal_cone(generators);
  return out;
}

// Directions that span the idealised star of a vertex.
std::vector<Vec3> vertex_directions(const SimplicialComplex& k, const Idealisation& ideal, int v) {
  std::vector<Vec3> directions;
  for (int c : ideal.vertex_chains[v]) {
    const Chain& chain = ideal.chains[std::size_t(c)];
    if (chain.first == v) directions.push_back(chain.direction);
    if (chain.last == v) directions.push_back(-chain.direction);
  }
  for (int t : k.vertex_triangles[v]) {
    const Vec3& n = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(t)])];
    for (int e : k.triangle_edges[std::size_t(t)]) {
      const auto& ends = k.edges[std::size_t(e)];
      if ((ends[0] != v && ends[1] != v) || ideal.edge_chain[std::size_t(e)] >= 0) continue;
      const Vec3 d = in_plane(at(k, ends[0] == v ? ends[1] : ends[0]) - at(k, v), n);
      if (d.norm() > 10 * ideal.tolerance) directions.push_back(d);
    }
  }
  return directions;
}

// A pointed hull is a corner of a solid, or the complement of a pit: a concave crease on an extreme ray
// tells.
bool is_pit(const Idealisation& ideal, const std::vector<Crease>& crease, const NormalCone& cone, int v) {
  for (int c : ideal.vertex_chains[v]) {
    const Chain& chain = ideal.chains[std::size_t(c)];
    const Vec3 d = chain.first == v ? chain.direction : Vec3(-chain.direction);
    const bool extreme = std::ranges::any_of(cone.rays, [&](const Vec3& g) { return (g - d).norm() < 1e-6; });
    if (extreme && crease[std::size_t(c)] == Crease::concave) return true;
  }
  return false;
}

Leaf face_leaf(const SimplicialComplex& k, const Idealisation& ideal, int t, double side) {
  const auto i = std::size_t(t);
  Leaf leaf;
  leaf.simplex_class = SimplexClass::face;
  leaf.dim = 2;
  leaf.simplex = t;
  leaf.region = ideal.triangle_region[i];
  const double sign = side * ideal.triangle_sign[i];
  leaf.direction = sign * ideal.region_normal[std::size_t(leaf.region)];
  leaf.extent = sign * ideal.region_offset[std::size_t(leaf.region)];
  for (std::size_t c = 0; c < 3; ++c) leaf.x[c] = at(k, k.triangles[i][c]);
  const Vec3 facing = side * leaf.direction;  // as the triangle is wound
  for (std::size_t c = 0; c < 3; ++c)
    leaf.conormal[c] = facing.cross(leaf.x[(c + 1) % 3] - leaf.x[c]).normalized();
  leaf.cone = face_cone(leaf.direction);
  return leaf;
}

double height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

void add_leaves(LmdShape& shape, double flat) {
  const SimplicialComplex& k = shape.complex;
  const Idealisation& ideal = shape.ideal;
  std::vector<Crease> crease(ideal.chains.size(), Crease::other);
  std::vector<ChainCone> cones;
  for (std::size_t c = 0; c < ideal.chains.size(); ++c) {
    cones.push_back(chain_cone(k, ideal, ideal.chains[c]));
    crease[c] = cones.back().crease;
  }
  for (int v = 0; v < int(k.vertices.size()); ++v) {
    if (ideal.vertex_chains[v].empty() && !k.vertex_edges[v].empty()) continue;  // inside a region or a chain
    NormalCone cone = make_normal_cone(vertex_directions(k, ideal, v));
    if (cone.lineality != 0 || (k.solid && is_pit(ideal, crease, cone, v))) continue;
    Leaf leaf;
    leaf.simplex_class = cone.rays.size() >= 3 ? SimplexClass::v_corner : SimplexClass::v_wide;
    leaf.simplex = leaf.region = v;
    leaf.x[0] = at(k, v);
    leaf.cone = std::move(cone);
    shape.leaves.push_back(std::move(leaf));
  }
  for (std::size_t c = 0; c < ideal.chains.size(); ++c) {
    if (cones[c].cone.lineality != 1) continue;
    const Chain& chain = ideal.chains[c];
    Leaf leaf;
    leaf.simplex_class = cones[c].cone.rays.size() == 2 ? SimplexClass::e_crease : SimplexClass::e_wide;
    leaf.dim = 1;
    leaf.simplex = leaf.region = int(c);
    leaf.x[0] = at(k, chain.first);
    leaf.x[1] = at(k, chain.last);
    leaf.direction = chain.direction;
    leaf.extent = (leaf.x[1] - leaf.x[0]).norm();
    leaf.cone = std::move(cones[c].cone);
    shape.leaves.push_back(std::move(leaf));
  }
  for (int t = 0; t < int(k.triangles.size()); ++t) {
    const auto& v = k.triangles[std::size_t(t)];
    if (height(at(k, v[0]), at(k, v[1]), at(k, v[2])) <= flat) {
      ++shape.flat_triangles;
      continue;
    }
    shape.leaves.push_back(face_leaf(k, ideal, t, 1));
    if (!k.solid) shape.leaves.push_back(face_leaf(k, ideal, t, -1));
  }
}

void add_base(LmdShape& shape) {
  const SimplicialComplex& k = shape.complex;
  for (const auto& t : k.triangles) shape.simplices.push_back({2, t});
  for (int e = 0; e < int(k.edges.size()); ++e)
    if (k.edge_triangles[e].empty())
      shape.simplices.push_back({1, {k.edges[std::size_t(e)][0], k.edges[std::size_t(e)][1], -1}});
  for (int v = 0; v < int(k.vertices.size()); ++v)
    if (k.vertex_edges[v].empty()) shape.simplices.push_back({0, {v, -1, -1}});
  std::vector<BvhItem> items;
  for (const BaseSimplex& s : shape.simplices) {
    BvhItem item;
    item.point_count = s.dim + 1;
    for (int i = 0; i <= s.dim; ++i) item.points[i] = at(k, s.vertex[std::size_t(i)]);
    items.push_back(item);
  }
  shape.base = build_bvh(items);
}

}  // namespace

LmdShape prepare(DilatedShape dilated, const LmdShapeOptions& options) {
  require_field(options.planarity >= 0 && options.planarity <= 1e-2, "LmdShapeOptions::planarity",
                options.planarity, "lie in [0, 1e-2]");
  require_field(std::isfinite(dilated.radius) && dilated.radius >= 0, "DilatedShape::radius", dilated.radius,
                "be finite and not negative [m]");
  require(!dilated.complex.vertices.empty(), "DilatedShape::complex has no vertex");

  LmdShape shape;
  shape.complex = std::move(dilated.complex);
  shape.radius = dilated.radius;
  const Box box = bounding_box(shape.complex);
  double tolerance = options.planarity * box.diagonal();
  if (shape.radius > 0)
    tolerance = std::min(tolerance, 1e-3 * shape.radius);  // far below what contacts can feel
  shape.ideal = idealise(shape.complex, tolerance);
  add_leaves(shape, 1e-9 * box.diagonal());
  add_base(shape);

  std::vector<BvhItem> items;
  for (const Leaf& leaf : shape.leaves) {
    BvhItem item;
    item.point_count = leaf.dim + 1;
    for (int i = 0; i <= leaf.dim; ++i) item.points[i] = leaf.x[i];
    item.axis = leaf.cone.axis;
    item.half_angle = leaf.cone.half_angle;
    item.classes = 1U << unsigned(leaf.simplex_class);
    items.push_back(item);
  }
  shape.bvh = build_bvh(items);
  shape.centre = (box.lo + box.hi) / 2;
  shape.bounding_radius = radius_about(shape.complex, shape.centre);
  return shape;
}

}  // namespace aussois
