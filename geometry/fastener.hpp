// SPDX-License-Identifier: Apache-2.0
// A CAD-like pair of our own making with a tight fit: a bolt and a nut with real ISO-metric threads.
// Both threads are the same helicoid, so the nut turns on the bolt with a constant gap.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct FastenerOptions {
  double diameter = 16e-3;   // nominal thread diameter [m]
  double pitch = 2e-3;       // [m] per turn
  double clearance = 1e-4;   // gap between the two threads, measured radially at the flanks, crest and root [m]
  int facets = 24;           // per turn
  int bolt_turns = 8;        // threaded length of the bolt in pitches
  int nut_turns = 3;         // height of the nut in pitches
};

/// Axis z; the threaded shank occupies z in [0, bolt_turns * pitch], the head lies below. A solid.
SimplicialComplex make_bolt(const FastenerOptions& options = {});
/// Axis z, hexagonal outside, z in [0, nut_turns * pitch]; at the identity pose its thread is in phase with the bolt's,
/// and so it is at every pose screw(angle) = rotation(z, angle) * translation(0, 0, pitch angle / 2 pi). A solid.
SimplicialComplex make_nut(const FastenerOptions& options = {});

}  // namespace aussois
