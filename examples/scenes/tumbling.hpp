// SPDX-License-Identifier: Apache-2.0
// Two free bodies that tumble on a joint.
#pragma once

#include "examples/common/random.hpp"
#include "integrators/run.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {

/// A joint of some kind between two free bodies, at places and times of no special kind.
struct Tumbling {
  Model model{};
  State state{};
  explicit Tumbling(JointKind kind) {
    Random random(11);
    model.gravity = Vec3::Zero();
    for (int i = 0; i < 2; ++i)
      add(model, RigidBody{.name = "body", .mass = 1.0 + i, .inertia = Vec3(0.2, 0.3, 0.4).asDiagonal()});
    state = rest_state(model);
    for (SE3& g : state.g) g = random.pose(1);
    Joint joint = joint_at(kind, "joint", 1, 0, state.g, random.pose(0.5));
    if (kind == JointKind::screw) joint.pitch = 0.5;
    if (kind == JointKind::distance)
      joint.length = 0.3, joint.frame_b = joint.frame_b * translation(0.1, 0.2, 0.2);
    add(model, joint);
    for (const BodyId i : state.g.ids()) twist(state, i) << random.vector(1), random.vector(3);
    state = consistent_state(model, state);
  }
};

}  // namespace aussois
