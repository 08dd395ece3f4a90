// SPDX-License-Identifier: Apache-2.0
#include "lmd/lmd_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/parallel.hpp"
#include "lmd/material_neighbours.hpp"
#include "lmd/normal_cone.hpp"
#include "lmd/shape_levels.hpp"
#include "lmd/shared_settings.hpp"
#include "lmd/star_cones.hpp"

namespace aussois {
namespace {

constexpr double kRounding =
    1e-9;  // of feet, relative to the size: all that is off where nothing is idealised

const Vec3& at(const SimplicialComplex& k, int v) {
  return k.vertices[v];
}

double height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

ConeTreeItem tree_item(std::span<const int> vertices, const Vec3& axis = Vec3::UnitZ(),
                       double half_angle = kPi) {
  ConeTreeItem item{.vertex_count = int(vertices.size()), .axis = axis, .half_angle = half_angle};
  std::ranges::copy(vertices, item.vertex.begin());
  return item;
}

// Calls f(i) for i in [0, n).
void in_chunks(int n, int threads, const auto& f) {
  constexpr int kChunk = 4096;
  parallel_for((n + kChunk - 1) / kChunk, threads, [&](int chunk) {
    for (int i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) f(i);
  });
}

// Calls f(i) for the simplices of a kind in the order of the shape's hierarchies, if it has one.
void in_order(const LmdShape& shape, std::vector<int> LeafOrder::*kind, std::size_t count, const auto& f) {
  for (std::size_t i = 0; i < count; ++i) f(shape.order ? ((*shape.order).*kind)[i] : int(i));
}

// Puts `leaves` in the order of a tree over `items`; those of a shape that deforms are in it.
template <class Leaf>
ConeTree make_tree(const std::vector<ConeTreeItem>& items, const LmdShape& shape, std::vector<Leaf>& leaves,
                   int threads) {
  if (shape.order) return enclosing_cone_tree(items, shape.complex.vertices, shape.centre);
  std::vector<int> order;
  ConeTree tree = build_cone_tree(items, shape.complex.vertices, shape.centre, order, threads);
  std::vector<Leaf> sorted;
  sorted.reserve(leaves.size());
  for (int i : order) sorted.push_back(leaves[i]);
  leaves = std::move(sorted);
  return tree;
}

void add_vertices(LmdShape& shape, const Idealisation& ideal, const std::vector<ChainCone>& cones,
                  int threads) {
  const SimplicialComplex& k = shape.complex;
  std::vector<VertexLeaf> narrow, wide;
  std::vector<ConeTreeItem> narrow_items, wide_items;
  std::vector<Vec3> rays;
  std::vector<std::vector<NormalCone>> of_vertex(k.vertices.size());  // of those that are leaves
  in_chunks(int(k.vertices.size()), threads, [&](int v) {
    if (ideal.vertex_chains[v].empty() && !k.vertex_edges[v].empty()) return;  // inside a region or a chain
    NormalCone cone = make_normal_cone(vertex_directions(k, ideal, v));
    const bool is_leaf = cone.lineality == 0 && !(k.solid && is_pit(ideal, cones, cone, v)) &&
                         !(shape.deforming && is_blunt(cone));
    if (shape.deforming) of_vertex[v] = soft_cones(k, ideal, v, is_leaf);
    if (is_leaf) of_vertex[v].push_back(std::move(cone));
  });
  std::vector<std::pair<int, const NormalCone*>> all;
  in_order(shape, &LeafOrder::vertices, k.vertices.size(), [&](int v) {
    for (const NormalCone& cone : of_vertex[v]) all.emplace_back(v, &cone);
  });
  for (const auto& [v, of] : all) {
    const NormalCone& cone = *of;
    const bool is_wide = cone.rays.size() < 3;
    const VertexLeaf leaf{.vertex = v,
                          .first_ray = int(rays.size()),
                          .ray_count = std::uint32_t(cone.rays.size()) & 0x3fffffffU,
                          .cyclic = cone.cyclic,
                          .is_wide = is_wide};
    rays.insert(rays.end(), cone.rays.begin(), cone.rays.end());
    const ConeTreeItem item = tree_item(std::array{v}, cone.axis, cone.half_angle);
    (is_wide ? wide : narrow).push_back(leaf);
    (is_wide ? wide_items : narrow_items).push_back(item);
  }
  shape.vertex_tree = make_tree(narrow_items, shape, narrow, threads);
  shape.wide_vertex_tree = make_tree(wide_items, shape, wide, threads);
  shape.narrow_vertices = int(narrow.size());
  narrow.insert(narrow.end(), wide.begin(), wide.end());
  shape.vertices = std::move(narrow);
  shape.rays = std::move(rays);
}

void add_edges(LmdShape& shape, const Idealisation& ideal, const std::vector<ChainCone>& cones,
               const std::vector<SoftEdge>& soft, const std::vector<double>& misfits, int threads) {
  std::vector<EdgeLeaf> narrow, wide;
  std::vector<ConeTreeItem> narrow_items, wide_items;
  std::vector<int> paths;
  const auto misfit = [&](int first, int last) { return std::max(misfits[first], misfits[last]); };
  const auto add_own = [&](int c) {
    const Chain& chain = ideal.chains[c];
    const std::span<const int> path = edges_of(ideal, chain);
    const EdgeLeaf leaf{.first = chain.first,
                        .last = chain.last,
                        .conormals = cones[c].conormals,
                        .path = path.size() == 1 ? path[0] : int(paths.size()),
                        .path_length = std::uint32_t(path.size()) & 0x7fffffffU,
                        .is_wide = *cones[c].simplex_class == SimplexClass::e_wide};
    if (path.size() > 1) paths.insert(paths.end(), path.begin(), path.end());
    const ConeTreeItem item = tree_item(std::array{chain.first, chain.last}, cones[c].axis,
                                        cones[c].half_angle + 1.01 * misfit(chain.first, chain.last));
    (leaf.is_wide ? wide : narrow).push_back(leaf);
    (leaf.is_wide ? wide_items : narrow_items).push_back(item);
  };
  const auto add_soft = [&](std::size_t i) {  // their regions follow those of the triangles
    const Chain& chain = ideal.chains[std::size_t(soft[i].chain)];
    const int region = int(ideal.region_normal.size() + 2 * i) + 1;
    narrow.push_back({.first = chain.first,
                      .last = chain.last,
                      .conormals = {region, region + 1},
                      .path = edges_of(ideal, chain).front()});
    narrow_items.push_back(tree_item(std::array{chain.first, chain.last}, soft[i].axis, soft[i].half_angle));
  };
  in_order(shape, &LeafOrder::edges, ideal.chains.size(), [&](int c) {
    if (cones[c].simplex_class) add_own(c);
    for (auto i = std::size_t(std::ranges::lower_bound(soft, c, {}, &SoftEdge::chain) - soft.begin());
         i < soft.size() && soft[i].chain == c; ++i)
      add_soft(i);
  });
  shape.edge_tree = make_tree(narrow_items, shape, narrow, threads);
  shape.wide_edge_tree = make_tree(wide_items, shape, wide, threads);
  shape.narrow_edges = int(narrow.size());
  narrow.insert(narrow.end(), wide.begin(), wide.end());
  std::vector<float> of_edge;
  for (const EdgeLeaf& leaf : narrow) of_edge.push_back(float(misfit(leaf.first, leaf.last)));
  if (std::ranges::any_of(of_edge, [](float m) { return m != 0; })) shape.misfits = std::move(of_edge);
  shape.edges = std::move(narrow);
  shape.paths = std::move(paths);
}

// Triangles are faces of contacts and simplices of the base complex; the latter has wires and points as well.
void add_faces(LmdShape& shape, const Idealisation& ideal, double flat, int threads) {
  const SimplicialComplex& k = shape.complex;
  std::vector<ConeTreeItem> items, rest_items;
  std::vector<int> faces;
  std::vector<BaseSimplex> rest;
  in_order(shape, &LeafOrder::triangles, k.triangles.size(), [&](int t) {
    const auto& v = k.triangles[t];
    ConeTreeItem item = tree_item(v);
    if (height(at(k, v[0]), at(k, v[1]), at(k, v[2])) <= flat) {
      ++shape.flat_triangles;
      rest.push_back({2, v});
      rest_items.push_back(item);
      return;
    }
    item.axis = ideal.triangle_sign[t] * ideal.region_normal[ideal.triangle_region[t]];
    item.half_angle = 0;
    faces.push_back(t);
    items.push_back(item);
  });
  in_order(shape, &LeafOrder::edges, k.edges.size(), [&](int e) {
    if (!k.edge_triangles[e].empty()) return;
    const auto& [a, b] = k.edges[e];
    rest.push_back({1, {a, b, -1}});
    rest_items.push_back(tree_item(k.edges[e]));
  });
  in_order(shape, &LeafOrder::vertices, k.vertices.size(), [&](int v) {
    if (!k.vertex_edges[v].empty()) return;
    rest.push_back({0, {v, -1, -1}});
    rest_items.push_back(tree_item(std::array{v}));
  });
  shape.face_tree = make_tree(items, shape, faces, threads);
  shape.rest_tree = make_tree(rest_items, shape, rest, threads);
  shape.faces = std::move(faces);
  shape.rest = std::move(rest);
}

Vec3 normal_of(const Idealisation& ideal, int triangle) {
  return ideal.triangle_sign[triangle] * ideal.region_normal[ideal.triangle_region[triangle]];
}

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The vertices of chains and faces that miss the conditions of (LMD-14) on the mesh.
std::vector<char> unproven_vertices(const LmdShape& shape, const Idealisation& ideal,
                                    const std::vector<double>& misfits) {
  constexpr double kLargestTilt = kPi / 180;  // of a face in its region
  const SimplicialComplex& k = shape.complex;
  const auto is_blunt = [&](const Chain& chain) {
    const auto sides = k.edge_triangles[edges_of(ideal, chain).front()];
    const double misfit = std::max(misfits[chain.first], misfits[chain.last]);
    return misfit > 0 && sides.size() == 2 &&
           angle(normal_of(ideal, sides[0]), normal_of(ideal, sides[1])) <= misfit;
  };
  const auto is_tilted = [&](int t) {
    const auto& v = k.triangles[t];
    if (height(at(k, v[0]), at(k, v[1]), at(k, v[2])) <= shape.tolerance)
      return false;  // its edges stand for it
    const Vec3 n = (at(k, v[1]) - at(k, v[0])).cross(at(k, v[2]) - at(k, v[0])),
               plane = ideal.region_normal[ideal.triangle_region[t]];
    return std::atan2(plane.cross(n).norm(), std::abs(plane.dot(n))) > kLargestTilt;  // or folded back on it
  };
  std::vector<char> mark(k.vertices.size(), 0);
  for (const Chain& chain : ideal.chains)
    if (is_blunt(chain))
      for (int e : edges_of(ideal, chain))
        for (int v : k.edges[e]) mark[v] = 1;
  for (int t : shape.faces)
    if (is_tilted(t))
      for (int v : k.triangles[t]) mark[v] = 1;
  return mark;
}

void add_unproven(LmdShape& shape, const Idealisation& ideal, const std::vector<double>& misfits,
                  int threads) {
  const std::vector<char> mark = unproven_vertices(shape, ideal, misfits);
  std::vector<ConeTreeItem> items;
  std::vector<int> unproven;
  for (int i = 0; i < base_count(shape); ++i) {
    const BaseSimplex s = base_simplex(shape, i);
    const std::span<const int> corners = std::span(s.vertex).first(std::size_t(s.dim) + 1);
    if (std::ranges::none_of(corners, [&](int v) { return mark[v] != 0; })) continue;
    unproven.push_back(i);
    items.push_back(tree_item(corners));
  }
  shape.unproven_tree = make_tree(items, shape, unproven, threads);
  shape.unproven = std::move(unproven);
}

// By the places of the simplices in a hierarchy over all of them.
std::shared_ptr<const LeafOrder> leaf_order(const SimplicialComplex& k, int threads) {
  const Box box = bounding_box(k);
  const auto order_of = [&](const auto& simplices, std::vector<int>& order) {
    std::vector<ConeTreeItem> items;
    for (const auto& simplex : simplices) items.push_back(tree_item(simplex));
    build_cone_tree(items, k.vertices, (box.lo + box.hi) / 2, order, threads);
  };
  LeafOrder out;
  std::vector<std::array<int, 1>> vertices;
  for (int v = 0; v < int(k.vertices.size()); ++v) vertices.push_back({v});
  order_of(vertices, out.vertices);
  order_of(k.edges, out.edges);
  order_of(k.triangles, out.triangles);
  return std::make_shared<const LeafOrder>(std::move(out));
}

// `order` is that of a shape that deforms.
LmdShape prepared(DilatedShape dilated, const LmdShapeOptions& options,
                  std::shared_ptr<const LeafOrder> order) {
  LmdShape shape;
  shape.complex = std::move(dilated.complex);
  shape.radius = dilated.radius;
  const Box box = bounding_box(shape.complex);
  shape.centre = (box.lo + box.hi) / 2;
  shape.bounding_radius = radius_about(shape.complex, shape.centre);
  shape.deforming = options.deforming;
  shape.order = std::move(order);
  shape.tolerance = (options.deforming ? kRounding : options.planarity) * box.diagonal();
  if (shape.radius > 0)
    shape.tolerance = std::min(shape.tolerance, 1e-3 * shape.radius);  // far below what contacts can feel

  const Idealisation ideal = (options.deforming ? idealise_each : idealise)(shape.complex, shape.tolerance);
  shape.straightened =
      straighten_chains(shape.complex, ideal, 1e-10 * box.diagonal());  // a tenth of what feet forgive
  std::vector<RegionPlane> regions;
  for (std::size_t r = 0; r < ideal.region_normal.size(); ++r)
    regions.push_back({ideal.region_normal[r], ideal.region_offset[r]});
  std::vector<std::int8_t> signs;
  for (double sign : ideal.triangle_sign) signs.push_back(std::int8_t(sign));
  std::vector<ChainCone> cones(ideal.chains.size());
  in_chunks(int(cones.size()), options.threads,
            [&](int c) { cones[c] = chain_cone(shape.complex, ideal, ideal.chains[c]); });
  std::vector<SoftEdge> soft;
  if (options.deforming) soft = soft_edges(shape.complex, ideal, cones);
  for (const SoftEdge& edge : soft)
    for (const Vec3& normal : edge.normals) regions.push_back({.normal = normal});
  shape.regions = std::move(regions);
  shape.triangle_region = ideal.triangle_region;
  shape.triangle_sign = std::move(signs);
  add_vertices(shape, ideal, cones, options.threads);
  const std::vector<double> misfits = misfit_at_vertices(shape.complex, ideal);
  add_edges(shape, ideal, cones, soft, misfits, options.threads);
  add_faces(shape, ideal, 1e-9 * box.diagonal(), options.threads);
  add_unproven(shape, ideal, misfits, options.threads);
  if (options.levels > 0)
    shape.levels = std::make_shared<const ShapeLevels>(make_levels(shape, options.levels, options.threads));
  return shape;
}

template <class T>
std::size_t bytes(const SharedArray<T>& v) {
  return v.size() * sizeof(T);
}

}  // namespace

void describe(SettingVisitor& visit, LmdShapeOptions& o) {
  visit.begin("LmdShapeOptions");
  visit.number(planarity_setting(), o.planarity);
  visit.toggle({"deforming", "keep every triangle and edge for a shape that deforms"}, o.deforming);
  visit.count({"levels",
               "maximum number of coarser surfaces that stand for the part where gaps are large",
               "",
               {0, kMostLevels}},
              o.levels);
  visit.count(threads_setting(), o.threads);
}

LmdShape prepare(DilatedShape dilated, const LmdShapeOptions& options) {
  check_ranges(options);
  require_field(std::isfinite(dilated.radius) && dilated.radius >= 0, "DilatedShape::radius", dilated.radius,
                "be finite and not negative [m]");
  require(!dilated.complex.vertices.empty(), "DilatedShape::complex has no vertex");
  require_field(!options.deforming || options.levels == 0, "LmdShapeOptions::levels", options.levels,
                "be 0 for a shape that deforms");
  auto order = options.deforming ? leaf_order(dilated.complex, options.threads) : nullptr;
  return prepared(std::move(dilated), options, std::move(order));
}

LmdShape refit(const LmdShape& shape, std::vector<Vec3> vertices) {
  require(shape.deforming, "refit: the shape must be prepared with LmdShapeOptions::deforming");
  require_field(vertices.size() == shape.complex.vertices.size(), "refit: number of vertices",
                vertices.size(),
                ("be " + std::to_string(shape.complex.vertices.size()) + ", as the shape has").c_str());
  DilatedShape moved{.complex = shape.complex, .radius = shape.radius};
  moved.complex.vertices = std::move(vertices);
  LmdShape out = prepared(std::move(moved), {.deforming = true}, shape.order);
  out.self = shape.self;
  return out;
}

LmdShape touching_itself(LmdShape shape, double reach) {
  require(shape.deforming, "touching_itself: the shape must be prepared with LmdShapeOptions::deforming");
  shape.self = material_neighbours(shape.complex, reach);
  return shape;
}

SimplexClass class_of(const VertexLeaf& leaf) {
  return leaf.is_wide ? SimplexClass::v_wide : SimplexClass::v_corner;
}

SimplexClass class_of(const EdgeLeaf& leaf) {
  return leaf.is_wide ? SimplexClass::e_wide : SimplexClass::e_crease;
}

std::size_t search_bytes(const LmdShape& s) {
  std::size_t total = bytes(s.complex.vertices) + bytes(s.complex.triangles) + bytes(s.regions) +
                      bytes(s.triangle_region) + bytes(s.triangle_sign) + bytes(s.rays) + bytes(s.paths) +
                      bytes(s.vertices) + bytes(s.edges) + bytes(s.misfits) + bytes(s.faces) + bytes(s.rest) +
                      bytes(s.unproven);
  for (const ConeTree* tree : {&s.vertex_tree, &s.wide_vertex_tree, &s.edge_tree, &s.wide_edge_tree,
                               &s.face_tree, &s.rest_tree, &s.unproven_tree})
    total += bytes(tree->nodes);
  return total;
}

int base_count(const LmdShape& shape) {
  return int(shape.faces.size() + shape.rest.size());
}

BaseSimplex base_simplex(const LmdShape& shape, int i) {
  const auto at = std::size_t(i);
  if (at < shape.faces.size()) return {2, shape.complex.triangles[shape.faces[at]]};
  return shape.rest[at - shape.faces.size()];
}

}  // namespace aussois
