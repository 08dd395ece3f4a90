// SPDX-License-Identifier: Apache-2.0
// Where a vertex goes when the planes around it all move inwards (ERO-2) to (ERO-4): to one point if the
// planes meet in one, otherwise to several, joined by new edges.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// A plane at a vertex, in the order in which the planes are met on a way around it, counter-clockwise seen
/// from outside.
struct VertexPlane {
  Vec3 normal = Vec3::UnitZ();  // unit, outwards
  Vec3 spoke = Vec3::UnitX();   // along the edge to the plane before, away from the vertex
  double offset = -1;           // of the moved plane { x : normal . x = offset } from the vertex
};

struct MitreOptions {
  double meet = 1e-6;  // planes that pass a point within this distance meet there [-]; > 0, from the rounding
                       // of coordinates in files
  double deviation = 0;  // planes that pass a point within this distance may be taken to meet if no split
                         // works [-]; >= 0
  bool split = true;     // a vertex may become several
};

/// All lengths in units of the way the planes move.
struct Mitre {
  std::vector<Vec3> points{};  // displacements of the vertex
  // The points on each plane, from the edge to the plane before to the edge to the plane after
  std::vector<std::vector<int>> of_plane{};
  double deviation = 0;  // largest distance of a point from a plane that it stands for
};

/// None if the planes neither meet within the options nor are there points and edges between them that bound
/// each plane by a simple polygon. Up to 40 planes are split.
std::optional<Mitre> mitre(std::span<const VertexPlane> planes, const MitreOptions& options = {});

/// A displacement for planes that have no mitre: the nearest to all, without going far (least squares).
Vec3 least_mitre(std::span<const VertexPlane> planes);

}  // namespace aussois
