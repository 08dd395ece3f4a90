// SPDX-License-Identifier: Apache-2.0
#include "integrators/tell/joint_work.hpp"

namespace aussois {
namespace {

// f(joint, row, impulse) of every row of every column.
template <class F>
void for_each_row(const std::vector<JointColumn>& columns, const VecX& lambda, const F& f) {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const JointColumn& c = columns[k];
    f(c, c.joint, c.row, lambda[Eigen::Index(k)]);
    if (c.other) f(c, c.other, c.of_other, lambda[Eigen::Index(k)]);
  }
}

}  // namespace

// A row of impulse p at a joint: its wrench on A, moved to the joint's frame (MJT-12).
void add_forces(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
                const PerBody<SE3>& g, double time, Table<JointId, StepJoint>& joints) {
  for_each_row(columns, lambda, [&](const JointColumn& column, JointId j, const JointRow& row, double p) {
    StepJoint& out = joints[j];
    if (column.kind == ColumnKind::motor) {
      out.effort[column.axis] += p / time;
      return;
    }
    const Joint& joint = model.joints[j];
    const SE3 body = joint.body_a ? g[joint.body_a] : SE3{};
    const Vec3 force = p / time * row.J_a.head<3>(), arm = frame_on_a(joint, g).p - body.p;
    out.force += force;
    out.torque += body.R * Vec3(p / time * row.J_a.tail<3>()) - arm.cross(force);
  });
}

namespace {

// Of an impulse along a row: `part` on both bodies, and what that leaves to moved ones.
void add_row_work(const Joint& joint, const JointRow& row, double p, const WorkVelocities& on, double& part,
                  double& supports) {
  part += p * axis_speed(joint, row, on.v);
  supports -= p * axis_speed(joint, row, on.moved);
}

}  // namespace

void add_effort(const AxisSlot& of, double p, double time, Table<JointId, StepJoint>& joints) {
  joints[of.joint].effort[of.axis] += (of.row == AxisRow::upper_stop ? -p : p) / time;
}

void add_column_work(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
                     const WorkVelocities& on, Table<JointId, StepJoint>& joints) {
  for_each_row(columns, lambda, [&](const JointColumn& column, JointId j, const JointRow& row, double p) {
    JointWork& work = joints[j].work;
    double& part = column.kind == ColumnKind::locked  ? work.locked
                   : column.kind == ColumnKind::motor ? work.motors
                                                      : work.couplings;
    add_row_work(model.joints[j], row, p, on, part, work.supports);
  });
}

void add_axis_work(const AxisSlot& of, double p, double u, double moved, Table<JointId, StepJoint>& joints) {
  JointWork& work = joints[of.joint].work;
  (of.row == AxisRow::motor      ? work.motors
   : of.row == AxisRow::friction ? work.friction
                                 : work.stops) += p * u;
  work.supports -= p * moved;
}

void add_spring_and_motor_work(const Model& model, const std::vector<AxisImpulse>& axes, const VecX& change,
                               const WorkVelocities& on, Table<JointId, StepJoint>& joints) {
  for (const AxisImpulse& axis : axes) {
    const Joint& joint = model.joints[axis.joint];
    JointWork& work = joints[axis.joint].work;
    const double spring = axis.spring - axis.D * axis_speed(joint, axis.row, change);
    add_row_work(joint, axis.row, axis.motor, on, work.motors, work.supports);
    add_row_work(joint, axis.row, spring, on, work.springs, work.supports);
  }
}

}  // namespace aussois
