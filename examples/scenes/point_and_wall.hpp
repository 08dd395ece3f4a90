// SPDX-License-Identifier: Apache-2.0
// A point of 1 kg on a line, in one coordinate of its own: a spring to the origin, a load, and a wall below
// (doc/theory/generalised_coordinates.md).
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// Stiffness [N/m], load [N], place of the wall [m], restitution.
inline Model point_and_wall(double k, double load, double wall, double restitution) {
  Model model;
  add(model, Coordinates{.name = "point",
                         .size = 1,
                         .mass = [](const VecX&) -> MatX { return MatX::Identity(1, 1); },
                         .force =
                             [=](double, const VecX& q, const VecX&) {
                               return CoordinateForce{.f = VecX::Constant(1, load - k * q[0]),
                                                      .K = MatX::Constant(1, 1, k)};
                             },
                         .potential = [=](const VecX& q) { return 0.5 * k * q[0] * q[0] - load * q[0]; }});
  add(model, GapFunction{.name = "wall",
                         .block = 0,
                         .evaluate =
                             [=](const Model& m, const State& state, double) {
                               return GapRows{.gap = coordinates(m, state, 0)[0] - wall,
                                              .J = MatX::Ones(1, 1)};
                             },
                         .law = {.mu = 0, .restitution = restitution}});
  return model;
}

}  // namespace aussois
