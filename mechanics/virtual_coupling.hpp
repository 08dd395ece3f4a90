// SPDX-License-Identifier: Apache-2.0
// A six-axis spring and damper that pulls a body along a recorded path or after a handle (VC-1) to (VC-6).
// The damper sees the velocity relative to the target, so there is no lag in free motion at constant speed
// [Colgate1995].
#pragma once

#include "lmd/body_id.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/trajectory.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct VirtualCouplingOptions {
  double stiffness = 1e4;          // [N/m]
  double rotation_stiffness = 10;  // [N m/rad]
  double damping_ratio = 1.0;      // of the critical damping of the coupled body alone [-]; for the
                                   // rotation with the mean of its principal moments of inertia (VC-3)
  double force_limit = kInf;       // largest pull [N]
  double torque_limit = kInf;      // largest torque [N m]
};
void validate(const VirtualCouplingOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, VirtualCouplingOptions& options);

struct CouplingWrench {
  Vec3 force = Vec3::Zero();   // on the body, world, at its centre of mass [N]
  Vec3 torque = Vec3::Zero();  // on the body, body frame [N m]
  bool saturated = false;      // a limit was reached
};
/// Pull on `body` at time t; `path` is the path of the body frame. Force and torque are scaled back to their
/// limits, each as a whole vector (VC-4).
CouplingWrench coupling_wrench(const Model& model, const State& state, BodyId body, const Trajectory& path,
                               const VirtualCouplingOptions& options, double t);

/// The force law with its potential, stiffness and damping (VC-5); the blocks of a saturated part are zero. K
/// is not symmetric for large rotation errors. Throws std::invalid_argument unless the body is dynamic and
/// path and options are valid.
ForceLaw virtual_coupling(const Model& model, BodyId body, Trajectory path,
                          const VirtualCouplingOptions& options = {});

/// The same with another body's frame as the target, wherever that body moves during the step. A driven body
/// is a handle that is led from step to step. Throws likewise, and also unless `handle` is another body that
/// is not dynamic.
CouplingWrench coupling_wrench(const Model& model, const State& state, BodyId body, BodyId handle,
                               const VirtualCouplingOptions& options, double t);
ForceLaw virtual_coupling(const Model& model, BodyId body, BodyId handle,
                          const VirtualCouplingOptions& options = {});

}  // namespace aussois
