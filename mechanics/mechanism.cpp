// SPDX-License-Identifier: Apache-2.0
#include "mechanics/mechanism.hpp"

#include <algorithm>
#include <cmath>

namespace aussois {
namespace {

double turned(const std::vector<int>& turns, JointId joint, int axis) {
  return turns.empty() ? 0 : 2 * kPi * turns[3 * joint.index() + axis];
}

JointRow with_turns(const Model& model, const JointPoses& at, const std::vector<int>& turns, JointId joint,
                    int axis) {
  JointRow row = axis_row(model.joints[joint], at, axis);
  row.value += turned(turns, joint, axis);
  return row;
}

void add_error(JointError& sum, bool is_rotation, double value) {
  double& worst = is_rotation ? sum.rotation : sum.translation;
  worst = std::max(worst, std::abs(value));
}

}  // namespace

double joint_coordinate(const Model& model, const State& state, JointId joint, int axis) {
  return with_turns(model, state.g, state.turns, joint, axis).value;
}

double joint_speed(const Model& model, const State& state, JointId joint, int axis) {
  const Joint& j = model.joints[joint];
  const JointRow row = axis_row(j, state.g, axis);
  double speed = 0;
  if (j.body_a) speed += row.J_a.dot(twist(state, j.body_a));
  if (j.body_b) speed += row.J_b.dot(twist(state, j.body_b));
  return speed;
}

JointError joint_error(const Model& model, const State& state, JointId joint) {
  const Joint& j = model.joints[joint];
  JointError error;
  int k = 0;
  for (const JointRow& row : locked_rows(j, state.g))
    add_error(error, k++ >= locked_translations(j.kind), row.value);
  return error;
}

JointError joint_error(const Model& model, const State& state) {
  JointError worst;
  for (const JointId j : model.joints.ids()) {
    const JointError error = joint_error(model, state, j);
    add_error(worst, false, error.translation);
    add_error(worst, true, error.rotation);
  }
  for (const Coupling& c : model.couplings)
    add_error(worst, is_angle(model.joints[c.joint_1].kind, c.axis_1),
              coupling_row(model, c, state.g, state.turns).value);
  return worst;
}

CouplingRow coupling_row(const Model& model, const Coupling& c, const JointPoses& at,
                         const std::vector<int>& turns) {
  CouplingRow row{.row_1 = with_turns(model, at, turns, c.joint_1, c.axis_1),
                  .row_2 = with_turns(model, at, turns, c.joint_2, c.axis_2)};
  row.value = row.row_1.value - c.ratio * row.row_2.value - c.offset;
  row.row_2.J_a *= -c.ratio;
  row.row_2.J_b *= -c.ratio;
  return row;
}

std::vector<int> counted_turns(const Model& model, const State& before, const PerBody<SE3>& after) {
  std::vector<int> turns = before.turns;
  turns.resize(3 * model.joints.size(), 0);
  for (const JointId j : model.joints.ids())
    for (int axis = 0; axis < axis_count(model.joints[j].kind); ++axis) {
      if (!is_angle(model.joints[j].kind, axis)) continue;
      const double was = axis_row(model.joints[j], before.g, axis).value,
                   is = axis_row(model.joints[j], after, axis).value;
      turns[3 * j.index() + axis] += int(std::lround((was - is) / (2 * kPi)));
    }
  return turns;
}

double spring_energy(const Model& model, const State& state) {  // (MJT-9)
  double sum = 0;
  for (const JointId j : model.joints.ids())
    for (int i = 0; i < axis_count(model.joints[j].kind); ++i) {
      const JointAxis& axis = model.joints[j].axis[i];
      if (axis.stiffness == 0) continue;
      const double x = joint_coordinate(model, state, j, i) - axis.rest;
      sum += 0.5 * axis.stiffness * x * x;
    }
  return sum;
}

}  // namespace aussois
