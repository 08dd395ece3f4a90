// SPDX-License-Identifier: Apache-2.0
// The planes of a solid's regions move inwards, and the borders between them with them: a wavefront of
// vertices, edges and faces. Where an edge has shrunk to nothing its ends meet and part again as the planes
// around them ask for; a face that has become a line vanishes. These events are taken in their order.
#pragma once

#include <array>
#include <vector>

#include "lmd/mitre.hpp"
#include "lmd/vertex_fans.hpp"

namespace aussois {

/// What follows counter-clockwise about a vertex of the wavefront: an edge, then a region up to the next.
struct WaveSector {
  int edge = -1;
  int region = 0;
  double offset = 0;  // of the region's plane { x : normal . x = offset } before it moves, as the solid's
                      // vertex has it from which this sector comes: exact though files round [m]
};

/// Moves on a straight line. A part of the history once it is not alive any more.
struct WaveVertex {
  std::vector<WaveSector> sectors{};
  std::vector<int> fans{};   // of the solid, from which it comes
  double since = 0;          // depth at which it was made [m]
  Vec3 from = Vec3::Zero();  // where [m]
  Vec3 to = Vec3::Zero();    // at the full depth, if nothing happens before [m]
  double deviation = 0;      // there from its planes, in depths
  bool alive = true;
};

struct WaveEdge {
  std::array<int, 2> ends{-1, -1};
  Vec3 direction = Vec3::UnitX();  // from the first to the second
  int chain = -1;                  // of the solid; -1: between regions that did not touch here
  bool alive = true;
};

struct WaveOptions {
  double depth = 0;         // [m]
  double meet = 1e-6;       // as in ErosionOptions
  double deviation = 1e-3;  // as in ErosionOptions
  bool split = true;        // as in ErosionOptions
  double together = 1e-6;   // events within this many depths are taken as one
};

/// What is asked of single fans.
struct FanOptions {
  std::vector<char> whole{};  // may not be split
  std::vector<int> group{};   // fans of one group are one vertex from the start, as are ends of edges that
                              // vanish; their edges must connect them
};

struct Wavefront {
  std::vector<WaveVertex> vertices{};
  std::vector<WaveEdge> edges{};
  std::vector<int> events{};  // first edge of each event, in their order
};

/// Vertices whose planes neither meet nor could be split keep a large deviation.
Wavefront move_planes(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                      const FanOptions& of_fan, const WaveOptions& options);

/// The other end of an edge.
inline int across(const WaveEdge& e, int vertex) {
  return e.ends[0] == vertex ? e.ends[1] : e.ends[0];
}

/// The position among the sectors of the one that starts with this edge.
inline int sector_of(const WaveVertex& v, int edge) {
  const auto at = std::ranges::find(v.sectors, edge, &WaveSector::edge);
  return int(at - v.sectors.begin());
}

}  // namespace aussois
