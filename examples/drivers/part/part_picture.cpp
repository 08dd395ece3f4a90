// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/part/part_picture.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace aussois {
namespace {

constexpr Colour kCrease = 0x1769d2, kSilent = 0xd4261c, kWide = 0xc77700, kCorner = 0x1c2430,
                 kDilated = 0xe3a12f;

// What the chains and the vertices of the idealised complex are to a contact.
struct Classes {
  Classes(const LmdShape& shape, const Idealisation& ideal)
      : chain(ideal.chains.size()), vertex(shape.complex.vertices.size()) {
    for (const EdgeLeaf& leaf : shape.edges) {
      const int edge = leaf.path_length == 1 ? leaf.path : shape.paths[leaf.path];
      chain[ideal.edge_chain[edge]] = class_of(leaf);
    }
    for (const VertexLeaf& leaf : shape.vertices) vertex[leaf.vertex] = class_of(leaf);
  }
  std::vector<std::optional<SimplexClass>> chain, vertex;  // none: silent
};

// Vertices of the idealised complex: ends of chains, and points.
std::vector<int> essential_vertices(const SimplicialComplex& k, const Idealisation& ideal) {
  std::vector<int> list;
  for (int v = 0; v < int(k.vertices.size()); ++v)
    if (!ideal.vertex_chains[v].empty() || k.vertex_edges[v].empty()) list.push_back(v);
  return list;
}

// Hues a golden section of the circle apart, so that neighbours differ; pale, so that lines stand out.
Colour region_colour(int region) {
  const double hue = std::fmod(0.61803398875 * region + 0.08, 1.0) * 6;
  const auto channel = [&](double shift) {
    const double t = std::fmod(hue + shift, 6.0);
    const double pure = std::clamp(std::abs(t - 3) - 1, 0.0, 1.0);
    return Colour(std::lround(255 * (0.52 + 0.40 * pure)));
  };
  return channel(0) << 16 | channel(4) << 8 | channel(2);
}

SurfaceLayer coloured(const std::string& name, const SimplicialComplex& k, const std::vector<int>& region) {
  SurfaceLayer layer{.name = name, .vertices = k.vertices.to_vector(), .triangles = k.triangles.to_vector()};
  for (int r : region) layer.colour.push_back(region_colour(r));
  return layer;
}

int strips(double angle) {
  return std::clamp(int(std::ceil(angle / (kPi / 12))), 1, 6);  // of at most 15 degrees
}

Vec3 between(const Vec3& n, const Vec3& m, double share) {
  return ((1 - share) * n + share * m).stableNormalized();
}

class DilatedSurface {
 public:
  DilatedSurface(const SimplicialComplex& solid, double radius) : k_(solid), radius_(radius) {
    layer_.name = "dilated";
    layer_.opacity = 0.35;
    for (const auto& [a, b, c] : k_.triangles)
      normal_.push_back((x(b) - x(a)).cross(x(c) - x(a)).stableNormalized());
    bend_.assign(k_.edges.size(), 0);
    for (int e = 0; e < int(k_.edges.size()); ++e) add_edge(e);
    for (std::size_t t = 0; t < k_.triangles.size(); ++t) {
      const auto& [a, b, c] = k_.triangles[t];
      add(point(a, normal_[t]), point(b, normal_[t]), point(c, normal_[t]));
    }
    for (int v = 0; v < int(k_.vertices.size()); ++v) add_corner(v);
    layer_.colour.assign(layer_.triangles.size(), kDilated);
  }
  SurfaceLayer take() { return std::move(layer_); }

 private:
  const Vec3& x(int v) const { return k_.vertices[v]; }
  int point(int v, const Vec3& n) {
    layer_.vertices.push_back(x(v) + radius_ * n);
    return int(layer_.vertices.size()) - 1;
  }
  void add(int a, int b, int c) { layer_.triangles.push_back({a, b, c}); }

  // A strip of a cylinder between the two faces of a convex edge.
  void add_edge(int e) {
    const auto both = k_.edge_triangles[e];
    if (both.size() != 2) return;
    auto [a, b] = k_.edges[e];
    int left = both[0], right = both[1];
    const auto& v = k_.triangles[left];
    for (std::size_t i = 0; i < 3; ++i)
      if (v[i] == b && v[(i + 1) % 3] == a) std::swap(left, right);
    const Vec3 &n = normal_[left], &m = normal_[right];
    const double sine = n.cross(m).dot((x(b) - x(a)).stableNormalized());
    bend_[e] = std::atan2(sine, n.dot(m));
    if (bend_[e] < 1e-6) return;
    const int count = strips(bend_[e]);
    for (int i = 0; i < count; ++i) {
      const Vec3 p = between(n, m, double(i) / count), q = between(n, m, double(i + 1) / count);
      const int ap = point(a, p), aq = point(a, q), bp = point(b, p), bq = point(b, q);
      add(bp, ap, aq);
      add(bp, aq, bq);
    }
  }

  // The piece of a ball between the normals around a convex corner.
  void add_corner(int v) {
    std::vector<Vec3> normals;
    Vec3 middle = Vec3::Zero();
    for (int e : k_.vertex_edges[v])
      if (bend_[e] < -1e-6) return;
    if (k_.vertex_triangles[v].empty()) return;
    const int first = k_.vertex_triangles[v][0];
    for (int t = first; normals.size() <= k_.vertex_triangles[v].size();) {
      if (normals.empty() || (normals.back() - normal_[t]).norm() > 1e-9) normals.push_back(normal_[t]);
      const auto& c = k_.triangles[t];
      const auto side = std::size_t(std::find(c.begin(), c.end(), v) - c.begin());
      const auto both = k_.edge_triangles[k_.triangle_edges[t][(side + 2) % 3]];
      if (both.size() != 2) return;
      t = both[0] == t ? both[1] : both[0];
      if (t == first) break;
    }
    while (normals.size() > 1 && (normals.front() - normals.back()).norm() <= 1e-9) normals.pop_back();
    if (normals.size() < 3) return;
    for (const Vec3& n : normals) middle += n;
    middle.normalize();
    for (std::size_t i = 0; i < normals.size(); ++i)
      add_patch(v, middle, normals[i], normals[(i + 1) % normals.size()]);
  }

  void add_patch(int v, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int n = strips(std::acos(std::clamp(b.dot(c), -1.0, 1.0)));
    std::vector<std::vector<int>> row(std::size_t(n) + 1);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= i; ++j)
        row[i].push_back(point(v, i == 0 ? a : between(a, between(b, c, double(j) / i), double(i) / n)));
    for (std::size_t i = 0; i < std::size_t(n); ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        add(row[i][j], row[i + 1][j], row[i + 1][j + 1]);
        if (j < i) add(row[i][j], row[i + 1][j + 1], row[i][j + 1]);
      }
  }

  const SimplicialComplex& k_;
  double radius_;
  SurfaceLayer layer_{};
  std::vector<Vec3> normal_{};
  std::vector<double> bend_{};
};

}  // namespace

ClassCounts count_classes(const LmdShape& shape, const Idealisation& ideal) {
  const Classes classes(shape, ideal);
  ClassCounts counts;
  counts.face = int(shape.faces.size());
  for (const std::optional<SimplexClass>& c : classes.chain) {
    counts.e_crease += c == SimplexClass::e_crease;
    counts.e_wide += c == SimplexClass::e_wide;
    counts.silent += !c;
  }
  for (int v : essential_vertices(shape.complex, ideal)) {
    const std::optional<SimplexClass> c = classes.vertex[v];
    counts.v_corner += c == SimplexClass::v_corner;
    counts.v_wide += c == SimplexClass::v_wide;
    counts.silent += !c;
  }
  return counts;
}

double median_bend(const SimplicialComplex& complex, const Idealisation& ideal) {
  std::vector<double> bends;
  for (const Chain& chain : ideal.chains)
    if (complex.edge_triangles[edges_of(ideal, chain).front()].size() == 2)
      bends.push_back(std::abs(kPi - interior_angle(complex, ideal, chain)));
  if (bends.empty()) return 0;
  std::ranges::nth_element(bends, bends.begin() + long(bends.size() / 2));
  return bends[bends.size() / 2];
}

SurfaceLayer dilated_surface(const SimplicialComplex& solid, double radius) {
  return DilatedSurface(solid, radius).take();
}

PartPicture part_picture(const LmdShape& shape, const Idealisation& ideal, const SimplicialComplex& eroded,
                         const std::vector<int>& eroded_region) {
  const SimplicialComplex& part = shape.complex;
  const double dilation = shape.radius;
  const Classes classes(shape, ideal);
  PartPicture picture;
  const bool has_eroded = !eroded.triangles.empty();
  picture.surfaces.push_back(coloured("part, regions in colours", part, ideal.triangle_region));
  if (has_eroded) {
    picture.surfaces.push_back(coloured("eroded part", eroded, eroded_region));
    picture.surfaces.back().shown = false;
  }
  if (part.solid && dilation > 0) {
    picture.surfaces.push_back(dilated_surface(has_eroded ? eroded : part, dilation));
    picture.surfaces.back().name = has_eroded ? "eroded and dilated" : "part, dilated";
    picture.surfaces.back().shown = false;
  }
  LineLayer convex{.name = "creases (convex chains)"}, silent{.name = "silent (concave chains)"},
      wide{.name = "wide edges (borders, wires)"};
  for (std::size_t i = 0; i < ideal.chains.size(); ++i) {
    const Chain& chain = ideal.chains[i];
    const std::optional<SimplexClass> c = classes.chain[i];
    LineLayer& layer = c == SimplexClass::e_wide ? wide : !c ? silent : convex;
    layer.lines.push_back({part.vertices[chain.first], part.vertices[chain.last]});
    layer.colour.push_back(c == SimplexClass::e_wide ? kWide : !c ? kSilent : kCrease);
  }
  PointLayer corners{.name = "corners"}, wide_points{.name = "wide vertices"},
      silent_points{.name = "silent vertices", .shown = false};
  for (int v : essential_vertices(part, ideal)) {
    const std::optional<SimplexClass> c = classes.vertex[v];
    PointLayer& layer = c == SimplexClass::v_corner ? corners
                        : c == SimplexClass::v_wide ? wide_points
                                                    : silent_points;
    layer.points.push_back(part.vertices[v]);
    layer.colour.push_back(c == SimplexClass::v_corner ? kCorner
                           : c == SimplexClass::v_wide ? kWide
                                                       : kSilent);
  }
  for (LineLayer* layer : {&convex, &silent, &wide})
    if (!layer->lines.empty()) picture.lines.push_back(std::move(*layer));
  for (PointLayer* layer : {&corners, &wide_points, &silent_points})
    if (!layer->points.empty()) picture.points.push_back(std::move(*layer));
  picture.legend = {{kCrease, "crease: edge that can touch"},
                    {kSilent, "silent: concave, can never touch"},
                    {kWide, "wide: border, wire or its end"},
                    {kCorner, "corner: vertex that can touch"}};
  if (part.solid && dilation > 0) picture.legend.emplace_back(kDilated, "dilated surface");
  return picture;
}

}  // namespace aussois
