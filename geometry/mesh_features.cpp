// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh_features.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "geometry/exact_point.hpp"
#include "geometry/mesh_report.hpp"
#include "geometry/min_norm_point.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

constexpr Named<VertexRule> kVertexRules[] = {{VertexRule::tangent_cone, "tangent_cone"},
                                              {VertexRule::moravanszky_terdiman, "moravanszky_terdiman"},
                                              {VertexRule::paper_exact, "paper_exact"}};

constexpr double kRounding = 1e-12;  // of unit vectors and what is made of a few of them

std::size_t side_of(const SimplicialComplex& k, int t, int e) {
  const auto& sides = k.triangle_edges[t];
  return std::size_t(std::find(sides.begin(), sides.end(), e) - sides.begin());
}

std::size_t corner_of(const SimplicialComplex& k, int t, int v) {
  const auto& corners = k.triangles[t];
  return std::size_t(std::find(corners.begin(), corners.end(), v) - corners.begin());
}

const Vec3& at(const SimplicialComplex& k, int v) {
  return k.vertices[v];
}

Vec3 direction(const SimplicialComplex& k, int from, int to) {
  return (at(k, to) - at(k, from)).stableNormalized();
}

Vec3 face_normal(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[t];
  return direction(k, a, b).cross(direction(k, a, c)).stableNormalized();
}

void weld(const SimplicialComplex& mesh, MeshFeatures& out) {
  out.vertex_of = first_at_same_place(mesh.vertices);
  std::vector<int> place(mesh.vertices.size(), -1);
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (out.vertex_of[i] != int(i)) {
      ++out.welded_vertices;
    } else {
      place[i] = int(vertices.size());
      vertices.push_back(mesh.vertices[i]);
    }
  }
  for (int& v : out.vertex_of) v = place[v];
  std::vector<std::array<int, 3>> triangles;
  for (std::array<int, 3> t : mesh.triangles) {
    for (int& v : t) v = out.vertex_of[v];
    const auto corner = [&](std::size_t i) { return exact(vertices[t[i]]); };
    if (CGAL::collinear(corner(0), corner(1), corner(2)))
      ++out.removed_triangles;
    else
      triangles.push_back(t);
  }
  out.complex = make_complex(std::move(vertices), std::move(triangles));
}

// (MF-1); the same whichever triangle comes first and wherever it begins.
void classify_edge(const SimplicialComplex& k, int e, double flat_angle, EdgeClass& c, double& bend) {
  const std::span<const int> around = k.edge_triangles[e];
  c = around.size() == 1 ? EdgeClass::boundary : EdgeClass::nonmanifold;
  if (around.size() != 2 || runs_upwards(k, around[0], e) == runs_upwards(k, around[1], e)) return;

  const bool first_up = runs_upwards(k, around[0], e);
  const int up = around[first_up ? 0 : 1], down = around[first_up ? 1 : 0];
  const auto [a, b] = k.edges[e];
  const int o1 = k.triangles[up][(side_of(k, up, e) + 2) % 3];
  const int o2 = k.triangles[down][(side_of(k, down, e) + 2) % 3];
  const Vec3 along = direction(k, a, b);
  const Vec3 n1 = along.cross(direction(k, a, o1)), n2 = direction(k, a, o2).cross(along);
  const double angle = std::atan2(n1.cross(n2).norm(), n1.dot(n2));
  const CGAL::Orientation side =
      CGAL::orientation(exact(at(k, a)), exact(at(k, b)), exact(at(k, o1)), exact(at(k, o2)));
  bend = side == CGAL::POSITIVE ? -angle : angle;
  if (angle <= flat_angle || (side == CGAL::COPLANAR && n1.dot(n2) > 0))
    c = EdgeClass::interior;
  else
    c = side == CGAL::POSITIVE ? EdgeClass::concave : EdgeClass::convex;
}

// Are the triangles at v joined to one another by edges at v?
bool is_one_fan(const SimplicialComplex& k, int v) {
  const std::span<const int> all = k.vertex_triangles[v];
  std::vector<int> reached = {all[0]};
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const int e : k.triangle_edges[reached[i]]) {
      const auto& ends = k.edges[e];
      if (ends[0] != v && ends[1] != v) continue;
      for (const int t : k.edge_triangles[e])
        if (std::find(reached.begin(), reached.end(), t) == reached.end()) reached.push_back(t);
    }
  return reached.size() == all.size();
}

std::vector<Vec3> edge_directions(const SimplicialComplex& k, int v) {
  std::vector<Vec3> d;
  for (const int e : k.vertex_edges[v]) {
    const auto [a, b] = k.edges[e];
    d.push_back(direction(k, v, a == v ? b : a));
  }
  return d;
}

// Sum of the face normals, weighted by their angles at v.
Vec3 vertex_normal(const SimplicialComplex& k, int v) {
  Vec3 m = Vec3::Zero();
  for (const int t : k.vertex_triangles[v]) {
    const auto& corners = k.triangles[t];
    const std::size_t i = corner_of(k, t, v);
    const Vec3 a = direction(k, v, corners[(i + 1) % 3]), b = direction(k, v, corners[(i + 2) % 3]);
    m += std::atan2(a.cross(b).norm(), a.dot(b)) * face_normal(k, t);
  }
  return m;
}

struct VertexVerdict {
  VertexClass kind = VertexClass::unused;
  bool by_cone = false, by_paper = false;  // active by (MF-3), by (MF-4)
};

VertexVerdict classify_vertex(const MeshFeatures& f, int v, double flat_angle) {
  const SimplicialComplex& k = f.complex;
  if (k.vertex_triangles[v].empty()) return {};
  std::array<int, 5> count{};  // of the edges here, by class
  for (const int e : k.vertex_edges[v]) ++count[std::size_t(f.edge_class[e])];
  const auto has = [&](EdgeClass c) { return count[std::size_t(c)] > 0; };
  const bool concave = has(EdgeClass::concave);
  VertexVerdict out;
  out.by_paper =
      !concave && (has(EdgeClass::convex) || has(EdgeClass::boundary) || has(EdgeClass::nonmanifold));
  if (has(EdgeClass::nonmanifold) || !is_one_fan(k, v)) {
    out.kind = VertexClass::nonmanifold;
    out.by_cone = true;
    return out;
  }
  const Vec3 nearest = min_norm_point(edge_directions(k, v)).point;  // -s n of (MF-3)
  const bool pointed = nearest.norm() > std::max(std::sin(flat_angle / 2), kHullContainsOrigin);
  if (has(EdgeClass::boundary)) {
    out.kind = VertexClass::boundary;
    out.by_cone = pointed;
    return out;
  }
  out.by_cone = pointed && -nearest.dot(vertex_normal(k, v)) > -kRounding;  // a thin sheet has no inside
  if (out.by_cone)
    out.kind = concave ? VertexClass::saddle_apex : VertexClass::convex;
  else
    out.kind = concave ? VertexClass::concave : VertexClass::interior;
  return out;
}

void set_vertex_bit(MeshFeatures& f, int t, int v) {
  f.triangle_flags[t] |= std::uint8_t(1u << corner_of(f.complex, t, v));
}

// The two passes of [Moravanszky2004]; owners make every active feature stand in one triangle.
void set_flags(MeshFeatures& f, VertexRule rule) {
  const SimplicialComplex& k = f.complex;
  f.triangle_flags.assign(k.triangles.size(), 0);
  std::vector<char> owned(k.vertices.size(), 0);
  for (int e = 0; e < int(k.edges.size()); ++e) {
    if (!is_active(f.edge_class[e])) continue;
    const int t = k.edge_triangles[e][0];
    f.triangle_flags[t] |= std::uint8_t(8u << side_of(k, t, e));
    if (rule == VertexRule::tangent_cone) continue;
    for (const int v : k.edges[e]) {
      if (rule == VertexRule::moravanszky_terdiman && owned[v]) continue;
      owned[v] = 1;
      set_vertex_bit(f, t, v);
    }
  }
  if (rule == VertexRule::tangent_cone) {
    for (int v = 0; v < int(k.vertices.size()); ++v)
      if (f.vertex_active[v]) set_vertex_bit(f, k.vertex_triangles[v][0], v);
    return;
  }
  for (int e = 0; e < int(k.edges.size()); ++e) {
    if (f.edge_class[e] != EdgeClass::concave) continue;
    for (const int v : k.edges[e])
      for (const int t : k.vertex_triangles[v])
        f.triangle_flags[t] &= std::uint8_t(~(1u << corner_of(k, t, v)));
  }
}

// u less its projection on cone{g}: the nearest point of the cone's polar (Moreau). The support grows by the
// generator that the rest leans on most, as in non-negative least squares [Lawson1974].
Vec3 project_on_polar(const std::vector<Vec3>& g, const Vec3& u) {
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;
  Vec3 rest = u;
  std::vector<Vec3> support;
  for (std::size_t round = 0; round < 4 * g.size() + 4; ++round) {
    const auto most = std::max_element(
        g.begin(), g.end(), [&](const Vec3& a, const Vec3& b) { return a.dot(rest) < b.dot(rest); });
    if (most->dot(rest) <= kRounding) break;
    support.push_back(*most);
    Vec3 best = rest;
    std::vector<Vec3> best_support;
    for (unsigned mask = 1; mask < 1u << support.size(); ++mask) {
      std::vector<Vec3> picked;
      for (std::size_t i = 0; i < support.size(); ++i)
        if (mask >> i & 1u) picked.push_back(support[i]);
      if (picked.size() > 3) continue;
      Columns A(3, Eigen::Index(picked.size()));
      for (std::size_t i = 0; i < picked.size(); ++i) A.col(Eigen::Index(i)) = picked[i];
      const Eigen::ColPivHouseholderQR<Columns> qr(A);
      if (qr.rank() < A.cols()) continue;
      const VecX weight = qr.solve(u);
      const Vec3 left = u - A * weight;
      if (weight.minCoeff() >= 0 && left.norm() < best.norm()) best = left, best_support = picked;
    }
    if (best_support.empty()) break;  // rounding: nothing is nearer
    rest = best;
    support = best_support;
  }
  return rest;
}

Vec3 nearer(const Vec3& a, const Vec3& b, const Vec3& normal) {
  return b.dot(normal) > a.dot(normal) ? b : a;
}

Vec3 admissible_on_edge(const MeshFeatures& f, int e, const Vec3& normal) {
  const SimplicialComplex& k = f.complex;
  const auto [a, b] = k.edges[e];
  const Vec3 along = direction(k, a, b);
  if (is_active(f.edge_class[e])) {
    std::vector<Vec3> tangents = {along, -along};
    for (const int t : k.edge_triangles[e]) {  // conormals
      const Vec3 to_third = direction(k, a, k.triangles[t][(side_of(k, t, e) + 2) % 3]);
      tangents.push_back((to_third - along.dot(to_third) * along).stableNormalized());
    }
    const Vec3 p = project_on_polar(tangents, normal);
    if (p.norm() > kRounding) return p.normalized();
  }
  Vec3 best = face_normal(k, k.edge_triangles[e][0]);
  for (const int t : k.edge_triangles[e]) best = nearer(best, face_normal(k, t), normal);
  return best;
}

Vec3 admissible_on_vertex(const MeshFeatures& f, int v, const Vec3& normal) {
  if (f.vertex_active[v]) {
    const Vec3 p = project_on_polar(edge_directions(f.complex, v), normal);
    if (p.norm() > kRounding) return p.normalized();
  }
  const std::span<const int> edges = f.complex.vertex_edges[v];
  Vec3 best = admissible_on_edge(f, edges[0], normal);
  for (const int e : edges) best = nearer(best, admissible_on_edge(f, e, normal), normal);
  return best;
}

}  // namespace

void describe(SettingVisitor& visit, MeshFeatureOptions& o) {
  visit.begin("MeshFeatureOptions");
  visit.number(
      {"flat_angle", "edges that bend by at most this are interior", "rad", range_open_above(0, kPi / 2)},
      o.flat_angle);
  visit.choice({"vertex_rule", "rule that finds the corners"}, o.vertex_rule, kVertexRules);
}

void validate(const MeshFeatureOptions& options) {
  check_ranges(options);
}

bool is_active(EdgeClass c) {
  return c == EdgeClass::convex || c == EdgeClass::boundary || c == EdgeClass::nonmanifold;
}

MeshFeatures find_mesh_features(const SimplicialComplex& mesh, const MeshFeatureOptions& options) {
  validate(options);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (const double x : mesh.vertices[v])
      if (!std::isfinite(x)) {
        const std::string field = "SimplicialComplex::vertices[" + std::to_string(v) + "]";
        require_field(false, field.c_str(), x, "be finite");
      }
  MeshFeatures f;
  weld(mesh, f);
  const std::size_t edges = f.complex.edges.size(), vertices = f.complex.vertices.size();
  f.edge_class.resize(edges);
  f.edge_bend.assign(edges, 0);
  for (std::size_t e = 0; e < edges; ++e)
    classify_edge(f.complex, int(e), options.flat_angle, f.edge_class[e], f.edge_bend[e]);
  for (std::size_t v = 0; v < vertices; ++v) {
    const VertexVerdict verdict = classify_vertex(f, int(v), options.flat_angle);
    f.vertex_class.push_back(verdict.kind);
    f.vertex_active.push_back(options.vertex_rule == VertexRule::tangent_cone ? verdict.by_cone
                                                                              : verdict.by_paper);
    if (verdict.kind == VertexClass::unused) continue;
    f.cells.both += verdict.by_cone && verdict.by_paper;
    f.cells.neither += !verdict.by_cone && !verdict.by_paper;
    f.cells.only_moravanszky_terdiman += !verdict.by_cone && verdict.by_paper;
    f.cells.only_tangent_cone += verdict.by_cone && !verdict.by_paper;
  }
  set_flags(f, options.vertex_rule);
  return f;
}

Vec3 admissible_normal(const MeshFeatures& features, int dim, int simplex, const Vec3& normal) {
  const SimplicialComplex& k = features.complex;
  require_field(dim >= 0 && dim <= 2, "admissible_normal: dim", dim, "lie in [0, 2]");
  const std::size_t count = dim == 0 ? k.vertices.size() : dim == 1 ? k.edges.size() : k.triangles.size();
  require_field(simplex >= 0 && std::size_t(simplex) < count, "admissible_normal: simplex", simplex,
                ("lie in [0, " + std::to_string(count) + ")").c_str());
  require(std::abs(normal.norm() - 1) <= 1e-6, "admissible_normal: the normal must have unit length (1e-6)");
  require(dim > 0 || !k.vertex_triangles[simplex].empty(),
          "admissible_normal: vertex " + std::to_string(simplex) + " belongs to no triangle");
  if (dim == 2) return face_normal(k, simplex);
  return dim == 1 ? admissible_on_edge(features, simplex, normal)
                  : admissible_on_vertex(features, simplex, normal);
}

}  // namespace aussois
