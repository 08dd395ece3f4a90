// SPDX-License-Identifier: Apache-2.0
#include "lmd/leaf.hpp"

#include <Eigen/Geometry>

namespace aussois {

Leaf leaf_of(const LmdShape& shape, LeafId id) {
  Leaf leaf;
  leaf.dim = id.dim;
  const auto& x = shape.complex.vertices;
  const auto i = std::size_t(id.index);
  if (id.dim == 0) {
    const VertexLeaf& v = shape.vertices[i];
    leaf.x[0] = x[v.vertex];
    leaf.rays = {shape.rays.data() + v.first_ray, std::size_t(v.ray_count)};
    leaf.cyclic = v.cyclic;
  } else if (id.dim == 1) {
    const EdgeLeaf& e = shape.edges[i];
    leaf.x[0] = x[e.first];
    leaf.x[1] = x[e.last];
    const Vec3 chord = leaf.x[1] - leaf.x[0];
    leaf.extent = chord.norm();
    leaf.direction = chord / leaf.extent;
    leaf.misfit = double(misfit_of(shape, id.index));
    for (int region : e.conormals) {
      if (region == 0) continue;
      const double sign = region > 0 ? 1 : -1;
      const Vec3& n = shape.regions[std::abs(region) - 1].normal;
      leaf.conormals[leaf.conormal_count++] = sign * n.cross(leaf.direction).normalized();
    }
  } else {
    const auto t = std::size_t(shape.faces[i]);
    const RegionPlane& plane = shape.regions[shape.triangle_region[t]];
    const double sign = id.side * shape.triangle_sign[t];
    for (std::size_t k = 0; k < 3; ++k) leaf.x[k] = x[shape.complex.triangles[t][k]];
    leaf.direction = sign * plane.normal;
    leaf.extent = sign * plane.offset;
    leaf.turn = id.side;
  }
  return leaf;
}

std::vector<int> corners_of(const LmdShape& shape, LeafId id) {
  const auto i = std::size_t(id.index);
  if (id.dim == 0) return {shape.vertices[i].vertex};
  if (id.dim == 1) return {shape.edges[i].first, shape.edges[i].last};
  const auto& t = shape.complex.triangles[shape.faces[i]];
  return {t.begin(), t.end()};
}

}  // namespace aussois
