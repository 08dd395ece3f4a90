// SPDX-License-Identifier: Apache-2.0
// Poses the joints of the one-step problem: equations for what is locked, rows for what acts along the axes
// (MJT-10) to (MJT-13). Also finds states in which all joints hold.
#pragma once

#include "integrators/pose/contact_problem.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {

/// The joints of the step's problem, in the form of FrictionProblem; empty without joints.
struct JointEquations {
  SparseMatrix G{};
  VecX b{};
};

/// Whether the error of the joints is within the options; any error is, if they do not project.
bool within(const JointError& error, const JointOptions& options);
/// Says that joints are off by more than the tolerance.
std::string text_of(const JointError& error, const JointOptions& options);

/// A column of G.
enum class ColumnKind { locked, motor, coupling };
struct JointColumn {
  ColumnKind kind = ColumnKind::locked;
  JointId joint{};
  int axis = 0;  // axis: of a motor
  JointRow row{};
  JointId other{};  // a coupling's second joint
  JointRow of_other{};
};

/// What acts at the joints; a column of G for every locked row and bilateral motor, then one per coupling.
struct JointSystem {
  JointEquations equations{};
  std::vector<JointColumn> columns{};
  PerBody<SE3> middle{};           // poses, or nearly those, at which the directions of locked rows are taken
  std::vector<ContactRow> rows{};  // stops, dry friction, limited motors
  VecX off{};                      // error of each column at the poses `middle` [m, rad]; speed motors: zero
};
JointSystem joint_system(const Model& model, const State& state, const Layout& dofs, const VecX& v_prescribed,
                         double h, double theta, const NormalRule& normal, const JointOptions& options);

/// For schemes whose velocity at the end must keep the joints there (GA-5): directions at the poses of `end`,
/// G^T v+ + b = 0 without stabilisation. Stops are those of the start.
JointSystem joint_system_at(const Model& model, const State& state, const State& end, const Layout& dofs,
                            const VecX& v_prescribed, double h, const NormalRule& normal);

/// The velocity of a whole step, the mean of its ends, indexed as State::v, and the state that it leads to.
struct ReachedEnd {
  const State& state;
  const VecX& v_path;
};
/// For schemes that iterate on the end of the step until it settles: directions on the mean of both ends
/// (MJT-14), positions at the end by Newton's method (MJT-15); theta = 1/2.
JointSystem joint_system_on_mean(const Model& model, const State& state, const ReachedEnd& end,
                                 const Layout& dofs, const VecX& v_prescribed, double h,
                                 const NormalRule& normal, const JointOptions& options);

/// What must hold at a state: joints, couplings, bilateral motors; in the order of the columns of
/// JointSystem.
struct JointConstraints {
  std::vector<JointColumn> columns{};
  SparseMatrix G{};  // directions as columns, in the rows of Layout
  VecX value{};      // zero where positions hold [m, rad]; for speed motors always zero
  VecX off{};        // J v minus its required value [m/s, rad/s]
};
JointConstraints joint_constraints(const Model& model, const State& state, const Layout& dofs);

/// A state in which all joints hold, and the impulses that changed its velocities.
struct ProjectedState {
  State state{};
  std::vector<JointColumn> columns{};
  VecX lambda{};  // [N s, N m s]
};
ProjectedState projected_state(const Model& model, const State& state);

/// The same for the velocities only, at the poses of the state.
ProjectedState with_consistent_velocity(const Model& model, const State& state);

}  // namespace aussois
