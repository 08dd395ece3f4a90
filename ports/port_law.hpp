// SPDX-License-Identifier: Apache-2.0
// The spring and damper by which a port holds a body at a grip, led by a handle (PORT-6) to (PORT-8).
#pragma once

#include "lmd/body_id.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/rigid_body.hpp"
#include "mechanics/trajectory.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges. Stiffnesses of zero hold nothing.
struct PortGains {
  double stiffness = 2e3;         // [N/m]
  double damping = 0;             // [N s/m]
  double rotation_stiffness = 2;  // [N m/rad]; 0 with no rotation_damping: the body hangs by its grip
  double rotation_damping = 0;    // [N m s/rad]
};
struct PortOptions {
  PortGains gains{};
  Vec3 grip = Vec3::Zero();    // where it holds, in the frame of the body [m]
  double force_limit = kInf;   // [N]
  double torque_limit = kInf;  // [N m]
};
void validate(const PortOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, PortGains& gains);
void describe(SettingVisitor& visit, PortOptions& options);

/// Gains whose dampers are critical for a body of this mass and mean moment of inertia (VC-3).
PortGains critical_gains(const RigidBody& body, double stiffness, double rotation_stiffness);

/// What a port exerts on the body, at its grip and in the world. The hand feels the opposite.
struct PortPull {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N m]
};
PortPull port_pull(const TrajectoryPoint& body, const TrajectoryPoint& handle, const PortOptions& options);

/// The law of a port. `handle` is a body that is not dynamic, whose frame says where the grip should be and
/// how the body should be turned; the law follows it through a step. The handle gets the opposite force, so
/// that law and handle together do the work that the potential loses. Throws std::invalid_argument: field,
/// value, bound.
ForceLaw port_law(const Model& model, BodyId body, BodyId handle, const PortOptions& options);

}  // namespace aussois
