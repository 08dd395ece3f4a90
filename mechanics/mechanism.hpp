// SPDX-License-Identifier: Apache-2.0
// The joints of a model at a state: coordinates, springs, drift (MJT-7) to (MJT-9).
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// The rows of a joint of the model (MJT-3) to (MJT-5). Where a body is carried, the coordinates that carry
/// it stand for its twist. A joint of a tree locks nothing, and its axes are coordinates (TREE-1).
std::vector<JointRow> locked_rows(const Model& model, const JointPoses& at, JointId joint);
JointRow axis_row(const Model& model, const JointPoses& at, JointId joint, int axis);

/// J . v of a row, with v laid out as State::v.
double axis_speed(const Joint& joint, const JointRow& row, const VecX& v);

/// Coordinate of a free axis, full turns included [m, rad], and its speed [m/s, rad/s].
double joint_coordinate(const Model& model, const State& state, JointId joint, int axis = 0);
double joint_speed(const Model& model, const State& state, JointId joint, int axis = 0);

/// The error of a joint at the state, and the largest error of all joints and couplings.
struct JointError {
  double translation = 0;  // [m]
  double rotation = 0;     // [rad], also of couplings between angles
};
JointError joint_error(const Model& model, const State& state, JointId joint);
JointError joint_error(const Model& model, const State& state);

/// q_1 - ratio q_2 - offset of a coupling, with its derivatives along its two joints (MJT-8).
struct CouplingRow {
  double value = 0;  // [m, rad], as for axis_1
  JointRow row_1{}, row_2{};
};
CouplingRow coupling_row(const Model& model, const Coupling& coupling, const JointPoses& at,
                         const std::vector<int>& turns);

/// Turns of all angles after a motion from `before` to `after` in which no angle moved by half a turn or more
/// (MJT-7).
std::vector<int> counted_turns(const Model& model, const State& before, const PerBody<SE3>& after);

/// Energy of the springs on joint axes [J].
double spring_energy(const Model& model, const State& state);

}  // namespace aussois
