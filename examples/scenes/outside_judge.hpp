// SPDX-License-Identifier: Apache-2.0
// Momentum and energy of a state from its poses and velocities alone, with none of the kernel's code: what
// ledgers are held against.
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// Of the bodies that move freely.
struct Judged {
  Vec3 linear = Vec3::Zero();   // [N s]
  Vec3 angular = Vec3::Zero();  // about the world's origin [N m s]
  double kinetic = 0;           // [J]
  double height = 0;            // - m g . x, the potential of the weight [J]
};

inline Judged judged_from_outside(const Model& model, const State& state) {
  Judged out;
  for (const BodyId b : model.bodies.ids()) {
    const RigidBody& body = model.bodies[b];
    if (!std::holds_alternative<DynamicMotion>(body.motion)) continue;
    const Vec3 x = state.g[b].p, v = linear_part(state.v, b), omega = angular_part(state.v, b),
               spin = body.inertia * omega;
    out.linear += body.mass * v;
    out.angular += body.mass * x.cross(v) + state.g[b].R.toRotationMatrix() * spin;
    out.kinetic += (body.mass * v.dot(v) + omega.dot(spin)) / 2;
    out.height -= body.mass * model.gravity.dot(x);
  }
  return out;
}

}  // namespace aussois
