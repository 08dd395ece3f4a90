// SPDX-License-Identifier: Apache-2.0
// A linear spring in space.
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// Between a body's centre and the origin [N/m], with its exact derivative.
inline ForceLaw spring(BodyId body, const Vec3& stiffness) {
  return {.name = "spring",
          .add_to =
              [=](const Model&, const State& state, double, GeneralisedForce& force) {
                linear_part(force.f, body) -= stiffness.cwiseProduct(pose(state, body).p);
                const int at = first_velocity(body);
                for (int i = 0; i < 3; ++i) force.K.emplace_back(at + i, at + i, stiffness[i]);
              },
          .potential = [=](const Model&, const State& state,
                           double) { return stiffness.dot(pose(state, body).p.cwiseAbs2()) / 2; }};
}

}  // namespace aussois
