// SPDX-License-Identifier: Apache-2.0
// Normal cones of the chains and vertices of a complex (LMD-1), (LMD-2), and of the flat and hollow ones of
// shapes that deform (DEF-5). Private to lmd.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lmd/lmd_shape.hpp"
#include "lmd/normal_cone.hpp"

namespace aussois {

/// The normal cone of a chain.
struct ChainCone {
  double rise = 0;  // solids: sine of the angle by which one side rises above the other; negative: convex
  std::optional<SimplexClass> simplex_class{};  // none: silent
  std::array<int, 2> conormals{};               // signed regions, as of EdgeLeaf
  Vec3 axis = Vec3::UnitZ();                    // of a cap around the normal cone
  double half_angle = 0;
};
ChainCone chain_cone(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain);

/// Directions that span the idealised star of a vertex.
std::vector<Vec3> vertex_directions(const SimplicialComplex& k, const Idealisation& ideal, int v);

/// Of a vertex of a solid whose star has a pointed hull: that is a corner, or the complement of a pit. The
/// creases on its extreme rays are all convex or all concave; the sharpest decides, since rounding may turn
/// one that is nearly flat.
bool is_pit(const Idealisation& ideal, const std::vector<ChainCone>& cones, const NormalCone& cone, int v);

/// Of a vertex of a shape that deforms: a corner so blunt that rounding may have made it. Its own cone says
/// nothing; soft_cones stand for it (DEF-5).
bool is_blunt(const NormalCone& cone);

/// The cones of a vertex on those sides on which its own does not stand for it; of wires that go on nearly
/// straight, on all sides (DEF-5).
std::vector<NormalCone> soft_cones(const SimplicialComplex& k, const Idealisation& ideal, int v,
                                   bool has_own);

/// The same of an edge between two triangles: its conormals, as normals of regions of their own.
struct SoftEdge {
  int chain = 0;
  std::array<Vec3, 2> normals{};
  Vec3 axis = Vec3::UnitZ();  // of a cap around the normal cone
  double half_angle = 0;
};
std::vector<SoftEdge> soft_edges(const SimplicialComplex& k, const Idealisation& ideal,
                                 const std::vector<ChainCone>& cones);

}  // namespace aussois
