// SPDX-License-Identifier: Apache-2.0
// A dilated complex prepared for contact determination: regions, chains, normal cones, classes and the
// hierarchies over its essential simplices. Immutable; shared between bodies.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/dilated_shape.hpp"
#include "lmd/cone_tree.hpp"
#include "lmd/idealisation.hpp"

namespace aussois {

class SettingVisitor;
struct MaterialNeighbours;
struct ShapeLevels;

/// `describe` gives the ranges.
struct LmdShapeOptions {
  double planarity = 1e-6;  // tolerance of planar regions and straight chains, relative to the box diagonal
                            // [-]
  bool deforming = false;   // each triangle is a region and each edge a chain, with the same index, which
                            // `refit` keeps; `planarity` is then ignored
  int levels = 0;           // most coarser surfaces to make (LOD-1); 0 for a shape that deforms
  int threads = 1;          // the shape is the same for any number
};
void describe(SettingVisitor& visit, LmdShapeOptions& options);

/// The role of a simplex in contacts (LMD-7); enlargement and partners depend on it. Simplices that can never
/// carry a contact are silent: they have no class and are not in the hierarchy.
enum class SimplexClass : std::uint8_t {
  v_corner,  // vertex with a pointed normal cone
  v_wide,    // end or bend of a wire, point, corner of a sheet: the normal cone contains a line or more
  e_crease,  // edge with a normal arc below 180 degrees
  e_wide,    // wire, or border of a sheet
};

/// A corner: an essential vertex.
struct VertexLeaf {
  int vertex = 0;
  int first_ray = 0;                 // in LmdShape::rays
  std::uint32_t ray_count : 30 = 0;  // extreme rays of its tangent cone, which has no lineality
  std::uint32_t cyclic : 1 = 1;      // see ConeView
  std::uint32_t is_wide : 1 = 0;     // the normal cone contains a line or more
};

/// A chain: a straight piece of the border between regions, of a sheet's border, or of wire.
struct EdgeLeaf {
  int first = 0, last = 0;         // its end vertices
  std::array<int, 2> conormals{};  // signed regions k: the conormal into region |k| - 1 is its normal x the
                                   // chain's direction, times the sign of k; 0: none
  int path = 0;                    // where its edges, from first to last, begin in LmdShape::paths; if it has
                                   // only one edge, that edge itself
  std::uint32_t path_length : 31 = 1;
  std::uint32_t is_wide : 1 = 0;  // wire or border
};

SimplexClass class_of(const VertexLeaf& leaf);
SimplexClass class_of(const EdgeLeaf& leaf);

/// A plane { x : normal . x = offset }: for solids and sheets, where the triangles of a region lie.
struct RegionPlane {
  Vec3 normal = Vec3::UnitZ();  // unit
  double offset = 0;            // [m]
};

/// A top simplex of the base complex: an isolated vertex, an edge without triangles, or a triangle.
struct BaseSimplex {
  int dim = 0;
  std::array<int, 3> vertex{};
};

/// The order of the simplices of a shape that deforms in its hierarchies, from the shape as it was prepared.
struct LeafOrder {
  std::vector<int> vertices{}, edges{}, triangles{};
};

struct LmdShape {
  SimplicialComplex complex{};
  double radius = 0;                        // dilation [m]
  Vec3 centre = Vec3::Zero();               // of a small ball around the vertices, frame of the shape [m]
  double bounding_radius = 0;               // of that ball, without dilation [m]
  bool deforming = false;                   // LmdShapeOptions::deforming: features are simplices
  double tolerance = 0;                     // of regions and chains, tau_f [m]
  SharedArray<MovedVertex> straightened{};  // vertices of the complex that were moved onto chords of chains

  SharedArray<RegionPlane> regions{};
  SharedArray<int> triangle_region{};        // of each triangle
  SharedArray<std::int8_t> triangle_sign{};  // +1 if the triangle faces as its region does, otherwise -1
  SharedArray<Vec3> rays{};
  SharedArray<int> paths{};
  SharedArray<VertexLeaf> vertices{};
  SharedArray<EdgeLeaf> edges{};
  SharedArray<float> misfits{};  // of the edges: how far feet may lie beyond the ends, per distance (LMD-15);
                                 // empty if it is 0 for all
  SharedArray<int> faces{};      // triangles; those of sheets have two sides
  SharedArray<BaseSimplex> rest{};  // base simplices that are not faces: too flat for a normal, wires, points
  // The hierarchies (LMD-9). The class set of a node is that of its tree.
  ConeTree vertex_tree{}, wide_vertex_tree{}, edge_tree{}, wide_edge_tree{}, face_tree{}, rest_tree{};
  int narrow_vertices = 0, narrow_edges = 0;  // the wide ones follow
  int flat_triangles = 0;  // triangles too flat to be faces of their own; their edges still count
  // Numbers of base simplices at creases no sharper than the misfit of their corners, and at faces higher
  // than the tolerance that are more than 1 degree off their regions, in the order of their tree: elsewhere
  // (LMD-14) is proven
  SharedArray<int> unproven{};
  ConeTree unproven_tree{};
  std::shared_ptr<const ShapeLevels> levels{};       // that may stand for it where gaps are large; null: none
  std::shared_ptr<const LeafOrder> order{};          // null: the shape does not deform
  std::shared_ptr<const MaterialNeighbours> self{};  // what does not touch itself; null: nothing does
};

/// How far a foot may lie beyond the ends of LmdShape::edges[edge], per distance from the foot [-] (LMD-15).
inline float misfit_of(const LmdShape& shape, int edge) {
  return shape.misfits.empty() ? 0.0F : shape.misfits[edge];
}

/// Throws std::invalid_argument for an empty complex, a dilation that is not a length, or a bad option.
LmdShape prepare(DilatedShape shape, const LmdShapeOptions& options = {});

/// Moves the vertices of a shape that was prepared with LmdShapeOptions::deforming: features keep their
/// indices, so contacts keep their keys, and the hierarchies their order: the time is linear in the number of
/// simplices. Contacts are those of the moved complex prepared afresh, whose hierarchies may be another.
/// Throws std::invalid_argument unless the shape deforms and `vertices` has one entry for each vertex.
LmdShape refit(const LmdShape& shape, std::vector<Vec3> vertices);

/// Lets a shape that was prepared with LmdShapeOptions::deforming touch itself, but for simplices nearer than
/// `reach` along the edges of the shape as it is now [m]. Throws std::invalid_argument unless reach > 0.
LmdShape touching_itself(LmdShape shape, double reach);

/// Bytes of what a search reads: vertices, triangles, leaves and trees.
std::size_t search_bytes(const LmdShape& shape);

/// The top simplices of the base complex are the faces, then the rest.
int base_count(const LmdShape& shape);
BaseSimplex base_simplex(const LmdShape& shape, int i);

}  // namespace aussois
