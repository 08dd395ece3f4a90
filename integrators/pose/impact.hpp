// SPDX-License-Identifier: Apache-2.0
// Impacts as a map of velocities, apart from the forces of the step: Newton's and Poisson's laws, all
// contacts at once or pair by pair (IMP-1) to (IMP-6).
#pragma once

#include <optional>

#include "integrators/pose/reduced_solve.hpp"

namespace aussois {

struct ImpactJump {
  VecX v{};                         // after the impact, rows of the problem
  std::vector<RowVector> r{};       // of every row of the step; zero for those that took no part [N s, N m s]
  VecX lambda{};                    // of the joints
  VecX of_contacts{}, of_joints{};  // impulses on the rows of the problem
  double kinetic_change = 0, contact_work = 0, joint_work = 0;  // [J]
  std::vector<double> work{};                                   // of every row on relative velocities [J]
  // Columns of the joints, the poses `middle` at which they act, and the mean velocity of the jump, rows of
  // the problem
  std::vector<JointColumn> columns{};
  PerBody<SE3> middle{};
  VecX v_mean{};
  int solves = 0;
  SolveReport solve{};  // effort of all solves, and their worst status
};

/// The jump at the contacts and gap functions among `rows`, as contact_rows and gap_rows made them at the
/// state. Nothing if none with restitution (sequential: none at all) closes within the step. Joints keep
/// their velocities; stops of joints take no part and are left to the step that follows.
std::optional<ImpactJump> impact_jump(const Model& model, const State& state, const Layout& dofs,
                                      const std::vector<ContactRow>& rows, const SparseMatrix& G, double h,
                                      NormalLaw law, const ImpactOptions& options,
                                      const SolverOptions& solver);

}  // namespace aussois
