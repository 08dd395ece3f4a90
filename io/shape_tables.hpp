// SPDX-License-Identifier: Apache-2.0
// Lists the tables of a prepared shape by name, to write and to read them, and says how an element lies in a
// file: as in memory.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lmd/shape_levels.hpp"

namespace aussois {

/// The plain numbers of an element, without gaps.
template <class T>
struct Plain {
  using type = T;
};
template <>
struct Plain<VertexLeaf> {
  using type = std::array<std::uint32_t, 3>;
};
template <>
struct Plain<EdgeLeaf> {
  using type = std::array<std::uint32_t, 6>;
};
template <>
struct Plain<RegionPlane> {
  using type = std::array<double, 4>;
};
template <>
struct Plain<BaseSimplex> {
  using type = std::array<int, 4>;
};
template <>
struct Plain<ConeNode> {
  using type = std::array<std::uint32_t, 80>;
};

template <class Archive, class Complex>
void visit_complex(Archive& archive, Complex& complex) {
  auto& [vertices, edges, triangles, triangle_edges, edge_triangles, vertex_edges, vertex_triangles, solid] =
      complex;
  archive.table("/mesh/vertices", vertices);
  archive.table("/mesh/edges", edges);
  archive.table("/mesh/triangles", triangles);
  archive.table("/mesh/triangle_edges", triangle_edges);
  archive.table("/mesh/edge_triangles/begin", edge_triangles.begin);
  archive.table("/mesh/edge_triangles/items", edge_triangles.items);
  archive.table("/mesh/vertex_edges/begin", vertex_edges.begin);
  archive.table("/mesh/vertex_edges/items", vertex_edges.items);
  archive.table("/mesh/vertex_triangles/begin", vertex_triangles.begin);
  archive.table("/mesh/vertex_triangles/items", vertex_triangles.items);
  archive.one("/mesh/solid", solid);
}

/// The tables of one shape in a group of those of another.
template <class Archive>
class InGroup {
 public:
  InGroup(Archive& archive, std::string group) : archive_(archive), group_(std::move(group)) {}
  template <class T>
  void table(const std::string& name, T& values) {
    archive_.table(group_ + name, values);
  }
  template <class T>
  void one(const std::string& name, T& value) {
    archive_.one(group_ + name, value);
  }

 private:
  Archive& archive_;
  std::string group_;
};

/// Every field but the levels by name, `deforming`, `order` and `self`, which shapes of files do not have:
/// one that is added to LmdShape does not compile until it stands here (raise kShapeVersion of
/// io/shape_cache.cpp then).
template <class Archive, class Shape>
void visit_own_tables(Archive& archive, Shape& shape) {
  auto& [complex, radius, centre, bounding_radius, deforming, tolerance, straightened, regions,
         triangle_region, triangle_sign, rays, paths, vertices, edges, misfits, faces, rest, vertex_tree,
         wide_vertex_tree, edge_tree, wide_edge_tree, face_tree, rest_tree, narrow_vertices, narrow_edges,
         flat_triangles, unproven, unproven_tree, levels, order, self] = shape;
  visit_complex(archive, complex);
  archive.one("/radius", radius);
  archive.one("/centre", centre);
  archive.one("/bounding_radius", bounding_radius);
  archive.one("/tolerance", tolerance);
  archive.table("/straightened", straightened);
  archive.table("/regions", regions);
  archive.table("/triangle_region", triangle_region);
  archive.table("/triangle_sign", triangle_sign);
  archive.table("/rays", rays);
  archive.table("/paths", paths);
  archive.table("/vertices", vertices);
  archive.table("/edges", edges);
  archive.table("/misfits", misfits);
  archive.table("/faces", faces);
  archive.table("/rest", rest);
  archive.table("/tree/vertex", vertex_tree.nodes);
  archive.table("/tree/wide_vertex", wide_vertex_tree.nodes);
  archive.table("/tree/edge", edge_tree.nodes);
  archive.table("/tree/wide_edge", wide_edge_tree.nodes);
  archive.table("/tree/face", face_tree.nodes);
  archive.table("/tree/rest", rest_tree.nodes);
  archive.table("/tree/unproven", unproven_tree.nodes);
  archive.one("/narrow_vertices", narrow_vertices);
  archive.one("/narrow_edges", narrow_edges);
  archive.one("/flat_triangles", flat_triangles);
  archive.table("/unproven", unproven);
  static_cast<void>(levels);
}

inline std::string level_group(std::size_t level) {
  return "/level/" + std::to_string(level);
}
template <class Archive, class Level>
void visit_level(Archive& archive, std::size_t number, Level& level) {
  InGroup<Archive> group(archive, level_group(number));
  group.one("/off", level.off);
  visit_own_tables(group, level.shape);
}
template <class Archive>  // writes
void visit_levels(Archive& archive, const std::shared_ptr<const ShapeLevels>& levels) {
  const std::vector<ShapeLevel> none, &all = levels ? levels->coarse : none;
  const int count = levels ? int(all.size()) : -1;
  archive.one("/levels", count);
  for (std::size_t k = 0; k < all.size(); ++k) visit_level(archive, k + 1, all[k]);
}
template <class Archive>  // reads
void visit_levels(Archive& archive, std::shared_ptr<const ShapeLevels>& levels) {
  int count = -1;
  archive.one("/levels", count);
  if (count < -1 || count > kMostLevels) archive.fail("/levels", "is not a number of levels, or -1");
  if (count < 0) return;
  ShapeLevels all;
  all.coarse.resize(std::size_t(count));
  for (std::size_t k = 0; k < all.coarse.size(); ++k) visit_level(archive, k + 1, all.coarse[k]);
  levels = std::make_shared<const ShapeLevels>(std::move(all));
}

template <class Archive, class Shape>
void visit_shape(Archive& archive, Shape& shape) {
  visit_own_tables(archive, shape);
  visit_levels(archive, shape.levels);
}

}  // namespace aussois
