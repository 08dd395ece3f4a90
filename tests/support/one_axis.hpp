// SPDX-License-Identifier: Apache-2.0
// One body on one axis: what stops, friction, springs and motors do is known in closed form.
#pragma once

#include "mechanics/mechanism.hpp"

namespace aussois {

inline const SE3 kAboutY = rotation(Vec3::UnitX(), -kPi / 2);  // the joint's z is the world's y

/// A wheel about the world's y of 1/2 kg m^2, or a slider along x; no gravity.
struct OneAxis {
  Model model{};
  State state{};
  explicit OneAxis(JointKind kind, double mass = 2) {
    model.gravity = Vec3::Zero();
    add(model, RigidBody{.name = "part", .mass = mass, .inertia = 0.5 * Mat3::Identity()});
    state = rest_state(model);
    const SE3 frame = kind == JointKind::prismatic ? rotation(Vec3::UnitY(), kPi / 2) : kAboutY;
    add(model, joint_at(kind, "axis", 0, kWorld, state.g, frame));
  }
  JointAxis& axis() { return model.joints[0].axis[0]; }
  double q() const { return joint_coordinate(model, state, 0); }
  double speed() const { return joint_speed(model, state, 0); }
};

}  // namespace aussois
