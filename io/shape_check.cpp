// SPDX-License-Identifier: Apache-2.0
#include "io/shape_check.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/hdf5_file.hpp"
#include "io/shape_tables.hpp"

namespace aussois {
namespace {

class MeshCheck {
 public:
  MeshCheck(hid_t file, const SimplicialComplex& mesh, std::string group = {})
      : file_(file), mesh_(mesh), group_(std::move(group)) {}

  // What make_complex promises, but for sums that only rounding could change.
  void all() const {
    const SimplicialComplex& k = mesh_;
    expect(!k.vertices.empty(), "/mesh/vertices", "is empty");
    for (const Vec3& x : k.vertices)
      expect(x.allFinite(), "/mesh/vertices", "has a place that is not finite");
    simplices<2>("/mesh/edges", k.edges);
    simplices<3>("/mesh/triangles", k.triangles);
    for (std::size_t e = 0; e < k.edges.size(); ++e)
      expect(k.edges[e][0] < k.edges[e][1] && (e == 0 || k.edges[e - 1] < k.edges[e]), "/mesh/edges",
             "is not in order");
    expect(k.triangle_edges.size() == k.triangles.size(), "/mesh/triangle_edges",
           "does not have one row per triangle");
    for (std::size_t t = 0; t < k.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const int e = k.triangle_edges[t][i];
        const std::array<int, 2> ends = {std::min(k.triangles[t][i], k.triangles[t][(i + 1) % 3]),
                                         std::max(k.triangles[t][i], k.triangles[t][(i + 1) % 3])};
        expect(within(e, k.edges.size()) && k.edges[std::size_t(e)] == ends, "/mesh/triangle_edges",
               "names an edge that does not join its corners");
      }
    incidence<3>("/mesh/edge_triangles", k.edge_triangles, k.edges.size(), k.triangle_edges);
    incidence<2>("/mesh/vertex_edges", k.vertex_edges, k.vertices.size(), k.edges);
    incidence<3>("/mesh/vertex_triangles", k.vertex_triangles, k.vertices.size(), k.triangles);
    expect(!k.solid || (is_closed_oriented(k) && signed_volume(k) > 0), "/mesh/solid",
           "calls a solid what encloses nothing");
  }

 protected:
  void expect(bool holds, const char* name, const char* what) const {
    if (!holds) fail_hdf5(file_, group_ + name, what);
  }
  static bool within(int i, std::size_t count) { return i >= 0 && std::size_t(i) < count; }
  static bool length(double x) { return std::isfinite(x) && x >= 0; }

 private:
  template <std::size_t N>
  void simplices(const char* name, std::span<const std::array<int, N>> all) const {
    for (const std::array<int, N>& simplex : all)
      for (std::size_t i = 0; i < N; ++i)
        expect(within(simplex[i], mesh_.vertices.size()) && simplex[i] != simplex[(i + 1) % N], name,
               "has an index outside the vertices of the mesh, or one twice");
  }
  // As many items as there are corners, ascending in each row, each with the row among its corners: all.
  template <std::size_t N>
  void incidence(const char* name, const Incidence& rows, std::size_t count,
                 std::span<const std::array<int, N>> corners) const {
    expect(rows.begin.size() == count + 1 && rows.begin.front() == 0 &&
               std::size_t(rows.begin.back()) == rows.items.size() && std::ranges::is_sorted(rows.begin) &&
               rows.items.size() == N * corners.size(),
           name, "does not have the sizes of its simplices");
    for (std::size_t row = 0; row < count; ++row)
      for (int last = -1; const int item : rows[int(row)]) {
        expect(
            item > last && within(item, corners.size()) &&
                std::ranges::find(corners[std::size_t(item)], int(row)) != corners[std::size_t(item)].end(),
            name, "is not that of its simplices");
        last = item;
      }
  }

  hid_t file_;
  const SimplicialComplex& mesh_;
  std::string group_;
};

class ShapeCheck : MeshCheck {
 public:
  ShapeCheck(hid_t file, const LmdShape& shape, std::string group = {})
      : MeshCheck(file, shape.complex, std::move(group)), s_(shape) {}

  void all() const {
    MeshCheck::all();
    tables();
    leaves();
    const std::size_t narrow_v = std::size_t(s_.narrow_vertices), narrow_e = std::size_t(s_.narrow_edges);
    tree("/tree/vertex", s_.vertex_tree, narrow_v);
    tree("/tree/wide_vertex", s_.wide_vertex_tree, s_.vertices.size() - narrow_v);
    tree("/tree/edge", s_.edge_tree, narrow_e);
    tree("/tree/wide_edge", s_.wide_edge_tree, s_.edges.size() - narrow_e);
    tree("/tree/face", s_.face_tree, s_.faces.size());
    tree("/tree/rest", s_.rest_tree, s_.rest.size());
    tree("/tree/unproven", s_.unproven_tree, s_.unproven.size());
  }

 private:
  void tables() const {
    const std::size_t triangles = s_.complex.triangles.size();
    expect(length(s_.radius), "/radius", "is not a length");
    expect(length(s_.bounding_radius) && s_.centre.allFinite(), "/bounding_radius",
           "is not a ball with its centre");
    expect(length(s_.tolerance), "/tolerance", "is not a length");
    expect(s_.narrow_vertices >= 0 && std::size_t(s_.narrow_vertices) <= s_.vertices.size(),
           "/narrow_vertices", "is not a valid number of vertices");
    expect(s_.narrow_edges >= 0 && std::size_t(s_.narrow_edges) <= s_.edges.size(), "/narrow_edges",
           "is not a valid number of edges");
    expect(s_.flat_triangles >= 0 && std::size_t(s_.flat_triangles) + s_.faces.size() == triangles,
           "/flat_triangles", "and the faces do not add up to all triangles");
    expect(s_.triangle_region.size() == triangles && s_.triangle_sign.size() == triangles, "/triangle_region",
           "does not have one row per triangle");
    for (const MovedVertex& moved : s_.straightened)
      expect(within(moved.vertex, s_.complex.vertices.size()) && moved.from.allFinite(), "/straightened",
             "has an index outside the vertices of the mesh, or a place that is not finite");
    for (const RegionPlane& p : s_.regions)
      expect(p.normal.allFinite() && std::isfinite(p.offset), "/regions", "has a plane that is not finite");
    for (const int r : s_.triangle_region)
      expect(within(r, s_.regions.size()), "/triangle_region", "has an index outside the regions");
    for (const int sign : s_.triangle_sign) expect(std::abs(sign) == 1, "/triangle_sign", "is not 1 or -1");
    for (const Vec3& ray : s_.rays) expect(ray.allFinite(), "/rays", "has a ray that is not finite");
    for (const int e : s_.paths)
      expect(within(e, s_.complex.edges.size()), "/paths", "has an index outside the edges of the mesh");
    for (const int t : s_.faces) expect(within(t, triangles), "/faces", "has an index outside the triangles");
    for (const int i : s_.unproven)
      expect(within(i, std::size_t(base_count(s_))), "/unproven", "has an index outside the base simplices");
  }

  void leaves() const {
    const std::size_t points = s_.complex.vertices.size(), mesh_edges = s_.complex.edges.size();
    for (const VertexLeaf& v : s_.vertices) {
      expect(within(v.vertex, points), "/vertices", "has an index outside the vertices of the mesh");
      expect(v.first_ray >= 0 && std::size_t(v.first_ray) + v.ray_count <= s_.rays.size(), "/vertices",
             "has an index outside the rays");
    }
    for (const EdgeLeaf& e : s_.edges) {
      expect(within(e.first, points) && within(e.last, points), "/edges",
             "has an index outside the vertices of the mesh");
      for (const int region : e.conormals)
        expect(std::abs(std::int64_t(region)) <= std::int64_t(s_.regions.size()), "/edges",
               "has an index outside the regions");
      expect(e.path_length == 1
                 ? within(e.path, mesh_edges)
                 : e.path_length > 1 && e.path >= 0 && std::size_t(e.path) + e.path_length <= s_.paths.size(),
             "/edges", "has a path that does not exist");
    }
    expect(s_.misfits.empty() || s_.misfits.size() == s_.edges.size(), "/misfits",
           "does not have one row per edge");
    for (const float misfit : s_.misfits)
      expect(misfit >= 0 && misfit <= 2, "/misfits", "is not a sum of two sines");
    for (const BaseSimplex& simplex : s_.rest) {
      expect(simplex.dim >= 0 && simplex.dim <= 2, "/rest", "has a dimension outside 0, 1, 2");
      for (int k = 0; k <= simplex.dim; ++k)
        expect(within(simplex.vertex[k], points), "/rest", "has an index outside the vertices of the mesh");
    }
  }

  // Children come after their parent, so the descent ends; every simplex lies in one bucket.
  void tree(const char* name, const ConeTree& tree, std::size_t simplices) const {
    std::vector<char> node_seen(tree.nodes.size()), simplex_seen(simplices);
    std::size_t nodes = tree.nodes.empty() ? 0 : 1, found = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      const ConeNode& node = tree.nodes[i];
      expect(finite(node), name, "has a number that is not finite");
      for (int lane = 0; lane < 4; ++lane) {
        if (node.r[lane] < 0) continue;
        const std::size_t first = node.child[lane], count = node.count[lane];
        if (count == 0) {
          expect(first > i && first < tree.nodes.size() && !node_seen[first], name, "is not a tree");
          node_seen[first] = 1;
          ++nodes;
          continue;
        }
        expect(count <= kBucket && first + count <= simplices, name, "has an index outside its simplices");
        for (std::size_t k = first; k < first + count; ++k) {
          expect(!simplex_seen[k], name, "holds a simplex twice");
          simplex_seen[k] = 1;
        }
        found += count;
      }
    }
    expect(nodes == tree.nodes.size() && found == simplices, name, "does not reach every node and simplex");
  }
  static bool finite(const ConeNode& node) {
    Plain<ConeNode>::type row;
    std::memcpy(row.data(), &node, sizeof row);
    constexpr std::size_t kFirst = offsetof(ConeNode, child) / 4, kLast = offsetof(ConeNode, u) / 4;
    for (std::size_t i = 0; i < row.size(); ++i)  // all words but the counts
      if ((i < kFirst || i >= kLast) && !std::isfinite(std::bit_cast<float>(row[i]))) return false;
    return true;
  }

  const LmdShape& s_;
};

}  // namespace

void check_shape(hid_t file, const LmdShape& shape) {
  ShapeCheck(file, shape).all();
  if (!shape.levels) return;
  for (std::size_t k = 0; k < shape.levels->coarse.size(); ++k) {
    const auto& [level, off] = shape.levels->coarse[k];
    const std::string group = level_group(k + 1);
    if (!(std::isfinite(off) && off >= 0 && level.radius >= shape.radius + off))
      fail_hdf5(file, group + "/off", "is not a length by which the level is dilated more");
    ShapeCheck(file, level, group).all();
  }
}

void check_complex(hid_t file, const SimplicialComplex& complex) {
  MeshCheck(file, complex).all();
}

}  // namespace aussois
