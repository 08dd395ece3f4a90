// SPDX-License-Identifier: Apache-2.0
// Scenes of cables, with geometry of their own.
#pragma once

#include "examples/scenes/cases.hpp"
#include "mechanics/cable.hpp"

namespace aussois {

/// 40 cm of rubber of 3 mm radius fall across a round peg, swing over it and slide off; `body` is the last
/// node.
CaseScene cable_on_peg();
/// A rope of 1.2 m, held at both ends, that a ball falls onto; `body` is the ball.
CaseScene ball_on_rope();
/// 1 m of rope of 4 mm radius is let down onto a floor and lays itself down in coils on itself; `body` is the
/// last node.
CaseScene rope_coil();
/// An overhand knot in a rope whose ends are drawn apart at 5 cm/s; `body` is the last node.
CaseScene knot();

/// A thin rope over half a peg of 96 sides, 1 N at its first end, the last one pulled along -y.
struct RopeOnPeg {
  static constexpr double kPeg = 0.1, kRope = 1e-4;                    // radii [m]
  static constexpr double kMu = 0.3, kStiffness = 1e4, kSpeed = 2e-3;  // EA [N], of the end [m/s]
  Model model{};
  State state{};
  Cable rope{};
  RopeOnPeg();
};
CaseScene capstan();  // `body` is the end that is pulled

/// A cable of rubber, threaded through three rings that are not in line, whose last node is pulled at 0.2 m/s
/// along x.
struct CableInClips {
  static constexpr double kRadius = 3e-3;              // of the cable [m]
  static constexpr double kRing = 8e-3, kWire = 2e-3;  // radii of the rings and of their wires [m]
  Model model{};
  State state{};
  Cable cable{};
  std::vector<Vec3> clips{};  // middles of the rings, which lie across x
  CableInClips();
};
CaseScene cable_in_clips();  // `body` is its first node

}  // namespace aussois
