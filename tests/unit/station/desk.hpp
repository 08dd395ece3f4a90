// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/primitives.hpp"
#include "mechanics/model.hpp"
#include "station/session_stage.hpp"

namespace aussois {

// A cube of 2 cm above a plate, held by a hand.
inline SessionScene desk(const SessionParameters& p) {
  SessionScene out;
  out.model.gravity = p.gravity;
  out.model.contact_law = {.mu = p.mu, .restitution = p.restitution};
  const ShapeId cube = add(out.model, prepare(dilate(make_box(0.02, 0.02, 0.02), p.dilation)));
  const ShapeId plate = add(out.model, prepare(dilate(make_plate(1, 1), p.dilation)));
  RigidBody part{.name = "part", .mass = 0.3, .inertia = 3e-5 * Mat3::Identity()};
  part.shape = cube;
  const BodyId body = add(out.model, std::move(part));
  add(out.model, fixed_body("plate", plate));
  out.port = add_port(out.model, body, p.port);
  out.start = rest_state(out.model);
  pose(out.start, body).p.z() = 0.02;
  return out;
}
inline SessionParameters parameters() {
  return {.tick = 2e-3, .dilation = 1e-3, .port = {.gains = {.stiffness = 2e3, .rotation_stiffness = 2}}};
}
}  // namespace aussois
