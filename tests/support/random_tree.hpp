// SPDX-License-Identifier: Apache-2.0
// Trees of bodies that hang on each other by joints of all kinds with coordinates, at random.
#pragma once

#include <vector>

#include "mechanics/tree.hpp"
#include "tests/support/random.hpp"

namespace aussois {

inline constexpr JointKind kKindsWithCoordinates[] = {JointKind::revolute,    JointKind::prismatic,
                                                      JointKind::cylindrical, JointKind::universal,
                                                      JointKind::planar,      JointKind::screw};

/// Body 0 is the base. Either side of a joint may be the one that is carried.
struct RandomTree {
  Model maximal{};  // before add_tree
  Model model{};
  std::vector<JointId> joints{};
};

inline Mat3 random_inertia(Random& random, double mass) {
  const Mat3 R = random.rotation().toRotationMatrix();
  const Vec3 d = 0.01 * (Vec3(1, 1.2, 1.4) + 0.3 * random.vector(1).cwiseAbs());
  return mass * (R * d.asDiagonal() * R.transpose());
}

inline RandomTree random_tree(Random& random, int links, bool floats) {
  RandomTree out;
  const auto body = [&](Motion motion) {
    const double mass = random.uniform(0.5, 2);
    add(out.maximal, RigidBody{.name = "body",
                               .mass = mass,
                               .inertia = random_inertia(random, mass),
                               .motion = std::move(motion)});
  };
  body(floats ? Motion(DynamicMotion{}) : Motion(FixedMotion{}));
  for (int i = 0; i < links; ++i) {
    body(DynamicMotion{});
    const BodyId parent = BodyId::at(int(random.uniform(0, i + 0.99))), child = BodyId::at(i + 1);
    const JointKind kind = kKindsWithCoordinates[i % 6];
    const bool a = i == 0 || random.uniform(0, 1) < 0.5;
    out.joints.push_back(add(out.maximal, Joint{.name = "joint",
                                                .kind = kind,
                                                .body_a = a ? child : parent,
                                                .body_b = a ? parent : child,
                                                .frame_a = random.pose(0.3),
                                                .frame_b = random.pose(0.3),
                                                .pitch = kind == JointKind::screw ? 0.3 : 0}));
  }
  out.model = out.maximal;
  add_tree(out.model, "tree", out.joints);
  return out;
}

/// Anywhere, in any motion.
inline State random_state(Random& random, const Model& model) {
  State state = rest_state(model);
  state.g[0] = random.pose(1);
  for (double& q : state.q) q = random.uniform(-1, 1);
  for (double& v : state.v) v = random.uniform(-1, 1);
  if (!is_dynamic(model.bodies[0])) twist(state, 0).setZero();
  carry(model, state);
  return state;
}

}  // namespace aussois
