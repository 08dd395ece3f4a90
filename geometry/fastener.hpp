// SPDX-License-Identifier: Apache-2.0
// Makes a CAD-like pair with a tight fit: a bolt and a nut with real ISO metric threads (60 degrees). Both
// threads are facetted helicoids of one profile (CPX-5); the bolt's is inscribed, the nut's circumscribed. At
// every screw angle, also between facets, the two solids therefore stay at least thread_gap() apart (CPX-6).
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct FastenerOptions {
  double diameter = 16e-3;  // nominal thread diameter [m]; across flats 1.5 diameter, head 0.65 diameter
  double pitch = 2e-3;      // rise per turn [m], at most diameter / 4; right-handed
  double clearance = 1e-4;  // radial gap, the same everywhere [m], at most pitch / 4; taken off the bolt
  int facets = 48;          // per turn, a multiple of 8
  int bolt_turns = 8;       // threaded length of the bolt in pitches
  int nut_turns = 3;        // height of the nut in pitches
};
void describe(SettingVisitor& visit, FastenerOptions& options);

/// A solid with axis z. The threaded shank occupies z in [0, bolt_turns * pitch] and ends in a plane cut; the
/// hexagonal head lies below it. Throws std::invalid_argument naming the option that is out of range.
SimplicialComplex make_bolt(const FastenerOptions& options = {});

/// A solid with axis z, hexagonal outside, z in [0, nut_turns * pitch]; both end planes cut the thread. At
/// the identity pose it sits on the bolt's head. Its thread is in phase with the bolt's there and at every
/// pose screw(angle) = rotation(z, angle) * translation(0, 0, pitch angle / (2 pi)).
SimplicialComplex make_nut(const FastenerOptions& options = {});

/// Radius of the bolt's helicoid at height s [m] in the half plane of angle 0 (CPX-5) [m]; the nut's is
/// larger by `clearance`. Periodic in s with the pitch.
double thread_radius(const FastenerOptions& options, double s);

/// Lower bound of the distance between the threads at any screw angle [m]: about clearance / 2, because the
/// flanks are inclined by 60 degrees (CPX-6). The distance never exceeds
/// (clearance + diameter / 2 (1 / cos(pi / facets) - 1)) / 2.
double thread_gap(const FastenerOptions& options = {});

}  // namespace aussois
