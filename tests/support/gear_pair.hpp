// SPDX-License-Identifier: Apache-2.0
// Two wheels about the world's y, geared, and a torque on the first.
#pragma once

#include "tests/support/one_axis.hpp"

namespace aussois {

/// 0.5 and 3 kg m^2, ratio -2.5, 7 N m; no gravity.
struct GearPair {
  Model model{};
  State state{};
  GearPair() {
    model.gravity = Vec3::Zero();
    for (const double J : {0.5, 3.0})
      add(model, RigidBody{.name = "wheel", .mass = 1, .inertia = J * Mat3::Identity()});
    state = rest_state(model);
    state.g[1].p.x() = 1;
    add(model, joint_at(JointKind::revolute, "first", 0, kWorld, state.g, kAboutY));
    add(model, joint_at(JointKind::revolute, "second", 1, kWorld, state.g, translation(1, 0, 0) * kAboutY));
    add(model, Coupling{.name = "gears", .joint_1 = 0, .joint_2 = 1, .ratio = -2.5});
    model.joints[0].axis[0].motor = {.kind = MotorKind::effort, .target = [](double) { return 7; }};
  }
};

}  // namespace aussois
