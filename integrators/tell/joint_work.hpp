// SPDX-License-Identifier: Apache-2.0
// Sums up what acted at joints: forces, efforts along axes, and work (MJT-12), (MJT-16).
#pragma once

#include "integrators/pose/joint_rows.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

/// Velocities that impulses work on, indexed as State::v.
struct WorkVelocities {
  VecX v{};      // all
  VecX moved{};  // those of moved bodies, zero elsewhere
};
/// Adds to the reports of the joints what impulses do over `time` [s]: `lambda` along columns, at the poses
/// `g`; `p` along a row of an axis.
void add_forces(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
                const PerBody<SE3>& g, double time, Table<JointId, StepJoint>& joints);
void add_effort(const AxisSlot& of, double p, double time, Table<JointId, StepJoint>& joints);
/// Adds their work (MJT-16); that of a row is on its speed `u`, of which `moved` is the part of moved bodies.
void add_column_work(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
                     const WorkVelocities& on, Table<JointId, StepJoint>& joints);
void add_axis_work(const AxisSlot& of, double p, double u, double moved, Table<JointId, StepJoint>& joints);
/// Adds the work of springs, dampers and effort motors; the velocity at the end differs by `change` from that
/// at the start.
void add_spring_and_motor_work(const Model& model, const std::vector<AxisImpulse>& axes, const VecX& change,
                               const WorkVelocities& on, Table<JointId, StepJoint>& joints);

}  // namespace aussois
