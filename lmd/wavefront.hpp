// SPDX-License-Identifier: Apache-2.0
// Moves the planes of a solid's regions inwards, and with them the borders between the regions: a wavefront
// of vertices, edges and faces. Where an edge has shrunk to nothing, its ends meet and part again as the
// planes around them require; a face that has become a line vanishes. These events are taken in order.
#pragma once

#include <array>
#include <vector>

#include "lmd/erosion.hpp"
#include "lmd/mitre.hpp"
#include "lmd/vertex_fans.hpp"

namespace aussois {

/// A sector about a vertex of the wavefront, counter-clockwise: an edge, then a region up to the next edge.
struct WaveSector {
  int edge = -1;
  int region = 0;
  double offset = 0;  // of the region's plane { x : normal . x = offset } before it moves, taken at the
                      // solid's vertex from which this sector comes: exact although files round [m]
};

/// Moves on a straight line. Part of the history once it is no longer alive.
struct WaveVertex {
  std::vector<WaveSector> sectors{};
  std::vector<int> fans{};   // of the solid, from which it comes
  double since = 0;          // depth at which it was made [m]
  Vec3 from = Vec3::Zero();  // where [m]
  Vec3 to = Vec3::Zero();    // at the full depth, unless something happens before [m]
  double deviation = 0;      // distance of `to` from its planes, in depths
  bool alive = true;
};

struct WaveEdge {
  std::array<int, 2> ends{-1, -1};
  Vec3 direction = Vec3::UnitX();  // from the first to the second
  int chain = -1;                  // of the solid; -1: between regions that did not touch here
  bool alive = true;
};

struct WaveOptions {
  double depth = 0;  // [m]
  double meet = ErosionOptions{}.meet;
  double deviation = ErosionOptions{}.deviation;
  bool split = ErosionOptions{}.split;
  double together = 1e-6;  // events within this many depths are taken as one
};

/// Requests for single fans.
struct FanOptions {
  std::vector<char> whole{};  // may not be split
  std::vector<int> group{};   // fans of one group are one vertex from the start, like the ends of edges that
                              // vanish; their edges must connect them
};

struct Wavefront {
  std::vector<WaveVertex> vertices{};
  std::vector<WaveEdge> edges{};
  std::vector<int> events{};  // first edge of each event, in order
};

/// Vertices whose planes do not meet and that could not be split keep a large deviation.
Wavefront move_planes(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                      const FanOptions& of_fan, const WaveOptions& options);

/// The other end of an edge.
inline int across(const WaveEdge& e, int vertex) {
  return e.ends[0] == vertex ? e.ends[1] : e.ends[0];
}

/// The index in `v.sectors` of the sector that starts with this edge.
inline int sector_of(const WaveVertex& v, int edge) {
  const auto at = std::ranges::find(v.sectors, edge, &WaveSector::edge);
  return int(at - v.sectors.begin());
}

}  // namespace aussois
