// SPDX-License-Identifier: Apache-2.0
// The spring and damper by which a port holds a body at a grip, led by a handle (PORT-6) to (PORT-8).
#pragma once

#include "lmd/body_id.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/rigid_body.hpp"
#include "mechanics/trajectory.hpp"

namespace aussois {

class SettingVisitor;

struct State;

/// `describe` gives the ranges. Stiffnesses of zero hold nothing.
struct PortGains {
  double stiffness = 2e3;         // [N/m]
  double damping = 0;             // [N s/m]
  double rotation_stiffness = 2;  // [N m/rad]; 0 with no rotation_damping: the body hangs by its grip
  double rotation_damping = 0;    // [N m s/rad]
};
/// How a port holds its body; it stands in State::u, and is constant over a step.
struct PortHold {
  PortGains gains{};
  Vec3 grip = Vec3::Zero();              // where it holds, in the frame of the body [m]
  double brake = 0, rotation_brake = 0;  // dampers against the world [N s/m], [N m s/rad]
};
/// `place` is the first entry of the hold in State::u, as `add_port_law` returns it.
PortHold port_hold(const State& state, int place);
void set_port_hold(State& state, int place, const PortHold& hold);  // throws like validate

struct PortLimits {
  double force = kInf;   // largest pull [N]
  double torque = kInf;  // [N m]
};
void validate(const PortGains& gains);  // throws std::invalid_argument: field, value, bound
void validate(const PortHold& hold);
void validate(const PortLimits& limits);
void describe(SettingVisitor& visit, PortGains& gains);
void describe(SettingVisitor& visit, PortLimits& limits);

/// Gains whose dampers are critical for a body of this mass and mean moment of inertia (VC-3).
PortGains critical_gains(const RigidBody& body, double stiffness, double rotation_stiffness);

/// What a port exerts on the body, at its grip and in the world. The hand feels the opposite.
struct PortPull {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N m]
};
PortPull port_pull(const TrajectoryPoint& body, const TrajectoryPoint& handle, const PortHold& hold,
                   const PortLimits& limits);

/// What its springs hold [J] (PORT-7).
double port_energy(const TrajectoryPoint& body, const TrajectoryPoint& handle, const PortHold& hold,
                   const PortLimits& limits);

/// Adds the law of a port and the inputs of its hold, which holds nothing at first; returns their place.
/// `handle` is a body that is not dynamic, whose frame says where the grip should be and how the body should
/// be turned; the law follows it through a step. The handle gets the opposite force, so that law and handle
/// together do the work that the potential loses. Throws std::invalid_argument: field, value, bound.
int add_port_law(Model& model, BodyId body, BodyId handle, const PortLimits& limits);

}  // namespace aussois
