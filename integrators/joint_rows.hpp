// SPDX-License-Identifier: Apache-2.0
// From joints to the one-step problem: equations for what is locked, rows for what acts along the axes
// (MJT-10) to (MJT-13); and states in which all joints hold.
#pragma once

#include "integrators/reduced_solve.hpp"
#include "integrators/step_report.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {

struct JointOptions {
  bool project = true;         // joints hold to rounding after each step, positions and velocities (MJT-13)
  double stabilisation = 0.2;  // part of the drift that a step takes back [-], in [0, 1] (MJT-11)
  double tolerance = 1e-6;     // before the first step and after each projection; what is off by more is
                               // refused [m, rad], > 0
};
/// Whether joints are as near as the options want them: of any error if they do not project.
bool within(const JointError& error, const JointOptions& options);
/// That joints are off by more than the tolerance.
std::string text_of(const JointError& error, const JointOptions& options);
void validate(const JointOptions& options);  // throws std::invalid_argument: field, value, bound

/// A column of G.
enum class ColumnKind { locked, motor, coupling };
struct JointColumn {
  ColumnKind kind = ColumnKind::locked;
  int joint = -1, axis = 0;  // axis: of a motor
  JointRow row{};
  int other = -1;  // a coupling's second joint
  JointRow of_other{};
};

/// What acts at the joints; a column of G for every locked row and bilateral motor, then one per coupling.
struct JointSystem {
  JointEquations equations{};
  std::vector<JointColumn> columns{};
  std::vector<SE3> middle{};       // poses that the directions of locked rows are taken at, or nearly
  std::vector<ContactRow> rows{};  // stops, dry friction, limited motors
  VecX off{};                      // of each column at the poses `middle` [m, rad]; speed motors: zero
};
JointSystem joint_system(const Model& model, const State& state, const Layout& dofs, const VecX& v_prescribed,
                         double h, double theta, const NormalLawOptions& normal, const JointOptions& options);

/// For schemes that ask the velocity at the end to keep the joints there (GA-5): directions at the poses of
/// `end`, G^T v+ + b = 0 without stabilisation. Stops are those of the start.
JointSystem joint_system_at(const Model& model, const State& state, const State& end, const Layout& dofs,
                            const VecX& v_prescribed, double h, const NormalLawOptions& normal);

/// A velocity of the whole step, mean of its ends, in the places of State::v, and where it leads.
struct ReachedEnd {
  const State& state;
  const VecX& v_path;
};
/// For schemes that know an end and come back until it stands: directions on the mean of both ends (MJT-14),
/// positions at the end by Newton (MJT-15); theta = 1/2.
JointSystem joint_system_on_mean(const Model& model, const State& state, const ReachedEnd& end,
                                 const Layout& dofs, const VecX& v_prescribed, double h,
                                 const NormalLawOptions& normal, const JointOptions& options);

/// Velocities that impulses work on, in the places of State::v.
struct WorkedOn {
  VecX v{};      // all
  VecX moved{};  // those of moved bodies, zero elsewhere
};
/// Adds to the report of the joints what impulses do over `time` [s]: `lambda` along columns, at the poses
/// `g`; `p` of the row that begins at an entry of State::r.
void add_forces(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
                const std::vector<SE3>& g, double time, std::vector<StepJoint>& joints);
void add_effort(int slot, double p, double time, std::vector<StepJoint>& joints);
/// And their work (MJT-16); of a row on its speed `u`, of which `moved` is that of moved bodies.
void add_work(const Model& model, const std::vector<JointColumn>& columns, const VecX& lambda,
              const WorkedOn& on, std::vector<StepJoint>& joints);
void add_work(int slot, double p, double u, double moved, std::vector<StepJoint>& joints);
/// Of springs, dampers and effort motors, with the velocity at the end off by `change` from that of the
/// start.
void add_work(const Model& model, const std::vector<AxisImpulse>& axes, const VecX& change,
              const WorkedOn& on, std::vector<StepJoint>& joints);

/// What must hold at a state: joints, couplings, bilateral motors; in the order of the columns of
/// JointSystem.
struct JointConstraints {
  std::vector<JointColumn> columns{};
  SparseMatrix G{};  // directions as columns, in the rows of Layout
  VecX value{};      // zero where positions hold [m, rad]; of speed motors always
  VecX off{};        // J v - what it is to be [m/s, rad/s]
};
JointConstraints joint_constraints(const Model& model, const State& state, const Layout& dofs);

/// The nearest poses, in the metric of the masses, at which all joints, couplings and position motors without
/// a limit hold (Newton, to 1e-13 m and rad or as far as rounding lets it), and the nearest velocities that
/// keep them so, and speed motors too (MJT-13). Also the way to a consistent start.
State consistent(const Model& model, const State& state);
/// The same with the impulses that the velocities changed by.
struct ProjectedState {
  State state{};
  std::vector<JointColumn> columns{};
  VecX lambda{};  // [N s, N m s]
};
ProjectedState projected(const Model& model, const State& state);

/// The velocities only, at the poses of the state.
VecX consistent_velocity(const Model& model, const State& state);

}  // namespace aussois
