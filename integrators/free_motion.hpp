// SPDX-License-Identifier: Apache-2.0
// What moves over one step of the theta scheme without contacts and joints, linearly implicit (MJ-4), (MJ-5).
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// Which rows of the problem belong to a body, six each; the coordinates come behind.
struct DofMap {
  std::vector<int> first{};  // per body: its first row, -1 if it is not dynamic
  int coordinates = 0;       // first row of the coordinates
  int rows = 0;
};
DofMap dof_map(const Model& model);
/// The row of an entry of State::v, -1 if its body is not dynamic.
int row_of(const DofMap& dofs, Eigen::Index velocity);

/// Velocities of the bodies that are not dynamic, in the places of State::v; zero for all that is free. A
/// prescribed body moves from its pose at t to that at t + h at constant speeds.
VecX prescribed_velocity(const Model& model, const State& state, double h);

/// Velocities in the places of State::v: the free ones from `v`, rows of the problem, the others from
/// `v_prescribed`.
VecX all_velocities(const DofMap& dofs, const VecX& v, const VecX& v_prescribed);
/// The opposite: the rows of the problem.
VecX free_velocities(const DofMap& dofs, const VecX& all);

/// Poses after the velocities `v`, in the places of State::v, for a time (MJ-8); prescribed bodies on their
/// path.
std::vector<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time);

/// Rows of the dynamic bodies and of the coordinates. M^ (v+ - v) = gravity + gyroscopic + laws + H r, where
/// what depends on v+ stands in M^.
struct FreeMotion {
  SparseMatrix M{};  // M^ = mass + gyroscopic_D + law_D
  VecX f{};          // momentum: M^ v_free = f [N s, N m s]
  VecX v{};          // velocity at the start of the step
  VecX v_free{};     // velocity at its end without contact
  SparseMatrix mass{};
  VecX gravity{};               // impulse over the step [N s]
  VecX gyroscopic{};            // h (-omega x J omega) at the start
  SparseMatrix gyroscopic_D{};  // h theta d(omega x J omega)/d omega
  VecX laws{};                  // h F - h^2 theta K v, forces of joint axes and coordinates included
  SparseMatrix law_D{};         // h theta C + h^2 theta^2 K
};

/// Adds springs, dampers and effort motors of the joints' axes at time t, with directions at the poses
/// `middle` (MJT-9).
void add_axis_forces(const Model& model, const State& state, const std::vector<SE3>& middle, double t,
                     GeneralisedForce& force);

/// `theta` in [1/2, 1].
FreeMotion free_motion(const Model& model, const State& state, const DofMap& dofs, double h, double theta);

}  // namespace aussois
