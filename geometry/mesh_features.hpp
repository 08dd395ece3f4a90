// SPDX-License-Identifier: Apache-2.0
// Finds the edges and vertices of a triangle mesh that can carry a contact, and marks each in one triangle
// (MF-1) to (MF-4). The bits are those of [Moravanszky2004]; the tangent-cone rule for vertices is exact
// where theirs is not. Wires and isolated points of a complex play no part.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

class SettingVisitor;

enum class VertexRule {
  tangent_cone,          // active if the polar of the tangent cone has an interior (MF-3)
  moravanszky_terdiman,  // active if an active edge ends there and no concave edge does (MF-4)
  paper_exact,           // the same as printed: no owners, so several triangles may mark one vertex
};

/// `describe` gives the ranges.
struct MeshFeatureOptions {
  double flat_angle = 0.1 * kPi / 180;  // edges that bend by at most this are interior [rad];
                                        // games use 5 degrees
  VertexRule vertex_rule = VertexRule::tangent_cone;
};
void validate(const MeshFeatureOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, MeshFeatureOptions& options);

enum class EdgeClass : std::uint8_t { interior, concave, convex, boundary, nonmanifold };
bool is_active(EdgeClass c);

enum class VertexClass : std::uint8_t {
  unused,       // in no triangle
  interior,     // inside a plane, or inside a straight convex edge
  concave,      // a pit, a saddle, the end of a crease
  saddle_apex,  // pointed although a concave edge ends there
  convex,       // pointed
  boundary,     // with a single open fan
  nonmanifold,  // several fans, or the end of a nonmanifold edge; always active
};

/// Counts the vertices of triangles by which of the two rules calls them active.
struct VertexRuleCells {
  int both = 0, neither = 0, only_moravanszky_terdiman = 0, only_tangent_cone = 0;
};

struct MeshFeatures {
  SimplicialComplex complex{};   // welded, without zero-area triangles; the indices below refer to it
  std::vector<int> vertex_of{};  // index in `complex` of each input vertex
  int welded_vertices = 0;       // vertices exactly coincident with an earlier one
  int removed_triangles = 0;     // of exactly zero area, or with a repeated corner after welding
  std::vector<EdgeClass> edge_class{};
  std::vector<double> edge_bend{};  // (MF-1) [rad], positive if convex, in [-pi, pi]; 0 without two triangles
  std::vector<VertexClass> vertex_class{};
  std::vector<char> vertex_active{};           // by the chosen rule
  std::vector<std::uint8_t> triangle_flags{};  // bit k: corner k; bit 3 + k: edge k, from corner k to k + 1
  VertexRuleCells cells{};
};

/// The result does not depend on the order of triangles or of their corners, except for which triangle holds
/// a bit. Throws std::invalid_argument naming the vertex if a coordinate is not finite.
MeshFeatures find_mesh_features(const SimplicialComplex& mesh, const MeshFeatureOptions& options = {});

/// Of the normals that a contact on simplex number `simplex` of dimension `dim` of features.complex may have,
/// the one nearest to `normal` (MF-5). Both are unit and point away from the mesh. Throws
/// std::invalid_argument if the simplex does not exist or belongs to no triangle, or if `normal` is not of
/// unit length (to 1e-6).
Vec3 admissible_normal(const MeshFeatures& features, int dim, int simplex, const Vec3& normal);

}  // namespace aussois
