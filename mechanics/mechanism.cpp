// SPDX-License-Identifier: Apache-2.0
#include "mechanics/mechanism.hpp"

#include <algorithm>
#include <cmath>

#include "mechanics/tree.hpp"

namespace aussois {
namespace {

// Moves what a row says of carried bodies to the coordinates that carry them. What is rounding of sums that
// vanish is dropped: an equation of the solver that is nothing but rounding would count as one.
JointRow carried(const Model& model, const PerBody<SE3>& g, const Joint& joint, JointRow row) {
  constexpr double kRounding = 1e-12;
  struct Entry {
    int velocity;
    double sum, terms;
  };
  std::vector<Entry> all;
  for (const auto& [body, J] : {std::pair(joint.body_a, &row.J_a), std::pair(joint.body_b, &row.J_b)}) {
    if (!body || !is_carried(model.bodies[body])) continue;
    for (const TwistColumn& c : carried_columns(model, g, body))
      all.push_back(
          {c.velocity, J->dot(c.twist),
           J->head<3>().norm() * c.twist.head<3>().norm() + J->tail<3>().norm() * c.twist.tail<3>().norm()});
    J->setZero();
  }
  std::ranges::stable_sort(all, {}, &Entry::velocity);
  for (auto entry = all.begin(); entry != all.end();) {
    Entry sum = *entry++;
    for (; entry != all.end() && entry->velocity == sum.velocity; ++entry)
      sum.sum += entry->sum, sum.terms += entry->terms;
    if (std::abs(sum.sum) > kRounding * sum.terms) row.others.emplace_back(sum.velocity, sum.sum);
  }
  return row;
}

double turned(const std::vector<int>& turns, JointId joint, int axis) {
  return turns.empty() ? 0 : 2 * kPi * turns[3 * joint.index() + axis];
}

JointRow with_turns(const Model& model, const JointPoses& at, const std::vector<int>& turns, JointId joint,
                    int axis) {
  JointRow row = axis_row(model, at, joint, axis);
  row.value += turned(turns, joint, axis);
  return row;
}

void add_error(JointError& sum, bool is_rotation, double value) {
  double& worst = is_rotation ? sum.rotation : sum.translation;
  worst = std::max(worst, std::abs(value));
}

}  // namespace

std::vector<JointRow> locked_rows(const Model& model, const JointPoses& at, JointId j) {
  const Joint& joint = model.joints[j];
  if (joint.tree) return {};
  std::vector<JointRow> out = locked_rows(joint, at);
  for (JointRow& row : out) row = carried(model, at.start, joint, std::move(row));
  return out;
}

JointRow axis_row(const Model& model, const JointPoses& at, JointId j, int axis) {
  const Joint& joint = model.joints[j];
  JointRow row = axis_row(joint, at, axis);
  if (!joint.tree) return carried(model, at.start, joint, std::move(row));
  return {.value = row.value, .others = {{tree_speed(model, j, axis), 1}}};
}

double axis_speed(const Joint& joint, const JointRow& row, const VecX& v) {
  double out = 0;
  if (joint.body_a) out += row.J_a.dot(body_part(v, joint.body_a));
  if (joint.body_b) out += row.J_b.dot(body_part(v, joint.body_b));
  for (const auto& [entry, factor] : row.others) out += factor * v[entry];
  return out;
}

double joint_coordinate(const Model& model, const State& state, JointId joint, int axis) {
  if (model.joints[joint].tree) return state.q[tree_coordinate(model, joint, axis)];
  return with_turns(model, state.g, state.turns, joint, axis).value;
}

double joint_speed(const Model& model, const State& state, JointId joint, int axis) {
  return axis_speed(model.joints[joint], axis_row(model, state.g, joint, axis), state.v);
}

JointError joint_error(const Model& model, const State& state, JointId joint) {
  const Joint& j = model.joints[joint];
  JointError error;
  int k = 0;
  for (const JointRow& row : locked_rows(j, state.g))  // of a tree too: rounding
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
  for (auto& [entry, factor] : row.row_2.others) factor *= -c.ratio;
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
