// SPDX-License-Identifier: Apache-2.0
// Which edges and vertices of a triangle mesh can carry a contact, each told by one triangle (MF-1) to
// (MF-4). Source of the bits: [Moravanszky2004]; the rule of tangent cones for vertices is exact where theirs
// is not. Wires and points of a complex are no part of this.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

enum class VertexRule {
  tangent_cone,          // active if the polar of the tangent cone has an interior (MF-3)
  moravanszky_terdiman,  // active if an active edge ends there and no concave one (MF-4)
  paper_exact,           // the same as printed: without owners, so in several triangles
};

struct MeshFeatureOptions {
  double flat_angle = 0.1 * kPi / 180;  // edges that bend by no more are interior [rad], in [0, pi/2); games
                                        // use 5 degrees
  VertexRule vertex_rule = VertexRule::tangent_cone;
};
void validate(const MeshFeatureOptions& options);  // throws std::invalid_argument: field, value, bound

enum class EdgeClass : std::uint8_t { interior, concave, convex, boundary, nonmanifold };
bool is_active(EdgeClass c);

enum class VertexClass : std::uint8_t {
  unused,       // of no triangle
  interior,     // of a plane, or of a straight convex edge
  concave,      // a pit, a saddle, the end of a crease
  saddle_apex,  // pointed although a concave edge ends there
  convex,       // pointed
  boundary,     // of a single open fan
  nonmanifold,  // several fans, or the end of a nonmanifold edge; always active
};

/// Vertices of triangles, by which of the rules calls them active.
struct VertexRuleCells {
  int both = 0, neither = 0, only_moravanszky_terdiman = 0, only_tangent_cone = 0;
};

struct MeshFeatures {
  SimplicialComplex complex{};   // welded, triangles without area left out: indices below refer to it
  std::vector<int> vertex_of{};  // of each vertex given
  int welded_vertices = 0;       // that were at the place of an earlier one, exactly
  int removed_triangles = 0;     // without area, exactly, or a repeated corner after welding
  std::vector<EdgeClass> edge_class{};
  std::vector<double> edge_bend{};  // (MF-1) [rad], positive if convex, in [-pi, pi]; 0 without two triangles
  std::vector<VertexClass> vertex_class{};
  std::vector<char> vertex_active{};           // by the rule asked for
  std::vector<std::uint8_t> triangle_flags{};  // bits 0 to 2: corner k, 3 to 5: edge k from corner k to k + 1
  VertexRuleCells cells{};
};

/// Does not depend on the order of triangles or of their corners (which triangle holds a bit does). Throws
/// std::invalid_argument naming the vertex if a coordinate is not finite.
MeshFeatures find_mesh_features(const SimplicialComplex& mesh, const MeshFeatureOptions& options = {});

/// The normal nearest to `normal`, unit and pointing away from the mesh, that a contact on simplex number
/// `simplex` of dimension `dim` of features.complex may have (MF-5). Throws std::invalid_argument if the
/// simplex does not exist or belongs to no triangle, or `normal` is not of unit length (1e-6).
Vec3 admissible_normal(const MeshFeatures& features, int dim, int simplex, const Vec3& normal);

}  // namespace aussois
