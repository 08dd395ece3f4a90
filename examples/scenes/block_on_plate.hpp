// SPDX-License-Identifier: Apache-2.0
// A cube of 10 cm on a plate: the small scene of many tests.
#pragma once

#include <cmath>

#include "geometry/primitives.hpp"
#include "mechanics/state.hpp"

namespace aussois {

inline constexpr double kSide = 0.1, kRadius = 1e-3, kDensity = 1000;

struct Scene {
  Model model{};
  BodyId ground{}, block{};
  State state{};
};

// A block at rest on a plate inclined by `slope` about y; gravity is tilted, not the plate.
inline Scene block_on_plate(double mu, double restitution, double slope, double height = 0) {
  Scene s;
  s.model.gravity = kGravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  s.model.contact_law = {.mu = mu, .restitution = restitution};
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const auto plate = add(s.model, prepare(dilate(make_plate(6, 6), kRadius)));
  const auto cube = add(s.model, prepare(dilate(box, kRadius)));
  s.ground = add(s.model, fixed_body("ground", plate));
  s.block = add(s.model, solid_body("block", cube, mass_properties(box, kDensity)));
  s.state = rest_state(s.model);
  pose(s.state, s.block).p.z() = kSide / 2 + 2 * kRadius + height;
  return s;
}

}  // namespace aussois
