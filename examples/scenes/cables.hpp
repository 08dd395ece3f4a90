// SPDX-License-Identifier: Apache-2.0
// Scenes of cables, with geometry of their own.
#pragma once

#include "examples/scenes/cases.hpp"

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

}  // namespace aussois
