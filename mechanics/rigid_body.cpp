// SPDX-License-Identifier: Apache-2.0
#include "mechanics/rigid_body.hpp"

namespace aussois {

RigidBody solid_body(std::string name, ShapeId shape, const MassProperties& mass) {
  const Vec3 to_shape = -mass.centre;
  return {.name = std::move(name),
          .shape = shape,
          .g_bs = translation(to_shape.x(), to_shape.y(), to_shape.z()),
          .mass = mass.mass,
          .inertia = mass.inertia};
}

RigidBody fixed_body(std::string name, ShapeId shape) {
  return {.name = std::move(name), .shape = shape, .motion = FixedMotion{}};
}

RigidBody prescribed_body(std::string name, ShapeId shape, Trajectory path) {
  return {.name = std::move(name), .shape = shape, .motion = PrescribedMotion{std::move(path)}};
}

RigidBody driven_body(std::string name, ShapeId shape) {
  return {.name = std::move(name), .shape = shape, .motion = DrivenMotion{}};
}

}  // namespace aussois
