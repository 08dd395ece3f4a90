// SPDX-License-Identifier: Apache-2.0
// Finds where a vertex goes when all planes around it move inwards (ERO-2) to (ERO-4): to one point if the
// planes meet in one, otherwise to several, joined by new edges.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

class SettingVisitor;

/// A plane at a vertex. The planes come in order around the vertex, counter-clockwise seen from outside.
struct VertexPlane {
  Vec3 normal = Vec3::UnitZ();  // unit, outwards
  Vec3 spoke = Vec3::UnitX();   // along the edge to the previous plane, away from the vertex
  double offset = -1;           // of the moved plane { x : normal . x = offset }, x from the vertex
};

/// `describe` gives the ranges.
struct MitreOptions {
  double meet = 1e-6;    // planes that pass a point within this distance meet there [-]: from the rounding
                         // of coordinates in files
  double deviation = 0;  // planes that pass a point within this distance may be taken to meet if no split
                         // works [-]
  bool split = true;     // a vertex may become several
};
void describe(SettingVisitor& visit, MitreOptions& options);

/// All lengths are in units of the distance that the planes move.
struct Mitre {
  std::vector<Vec3> points{};  // displacements of the vertex
  // The points on each plane, from the edge to the previous plane to the edge to the next plane
  std::vector<std::vector<int>> of_plane{};
  double deviation = 0;  // largest distance of a point from one of its planes
};

/// nullopt if the planes do not meet within the options, and no points and edges between them bound each
/// plane by a simple polygon. Up to 40 planes are split. Throws std::invalid_argument for a bad option.
std::optional<Mitre> mitre(std::span<const VertexPlane> planes, const MitreOptions& options = {});

/// A displacement for planes that have no mitre: nearest to all of them without going far (least squares).
Vec3 least_mitre(std::span<const VertexPlane> planes);

}  // namespace aussois
