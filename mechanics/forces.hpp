// SPDX-License-Identifier: Apache-2.0
// Forces on bodies and coordinates apart from contacts: gravity, gyroscopic torques, laws, axes of joints.
#pragma once

#include "mechanics/layout.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// What a spring, a damper and an effort motor exert along an axis of a joint: an impulse over a step
/// [N s, N m s], or a force [N, N m].
struct AxisImpulse {
  JointId joint{};
  int axis = 0;
  JointRow row{};
  double motor = 0;
  double spring = 0;  // of spring and damper, if the velocity does not change
  double D = 0;       // `spring` falls by D times J times the change of the velocity [N s^2/m, N m s^2]
};

/// Adds the springs, dampers and effort motors of the joints' axes at time t, with directions at the poses
/// `middle` (MJT-9), and returns them one by one.
std::vector<AxisImpulse> add_axis_forces(const Model& model, const State& state, const PerBody<SE3>& middle,
                                         double t, GeneralisedForce& force);
/// Whether any joint axis of the model has a spring, a damper or an effort motor.
bool has_axis_forces(const Model& model);
/// Impulses over a step of length h, by the trapezoidal rule from the forces at its start and end.
std::vector<AxisImpulse> trapezoidal_impulses(double h, std::vector<AxisImpulse> start,
                                              const std::vector<AxisImpulse>& end);

/// The derivative of the torque omega x J omega with respect to omega, body frame.
Mat3 gyroscopic_derivative(const Mat3& J, const Vec3& omega);

/// An n x n sparse matrix with these entries; entries at the same place are summed.
SparseMatrix square_matrix(int n, const std::vector<Triplet>& entries);
/// The entries between free rows, renumbered.
std::vector<Triplet> free_entries(const std::vector<Triplet>& entries, const Layout& dofs);
/// Appends `scale` times a block whose corner is at (at, at), without its zeros.
void add_diagonal_block(std::vector<Triplet>& matrix, int at, const MatX& block, double scale);
void add_diagonal_block(std::vector<Triplet>& matrix, int at, const SparseMatrix& block, double scale);

/// Appends the masses of all dynamic bodies.
void add_body_masses(const Model& model, const Layout& dofs, std::vector<Triplet>& matrix);
/// The masses of all bodies and coordinates at a state, in the rows of the problem.
SparseMatrix mass_matrix(const Model& model, const State& state, const Layout& dofs);

/// All forces at a state and at its own time, in the rows of the problem; includes joint axes and
/// coordinates.
struct Forces {
  SparseMatrix mass{};                   // at the state's coordinates
  VecX gravity{}, gyroscopic{}, laws{};  // [N, N m]
  SparseMatrix K{}, C{};                 // -df/dq and -df/dv of the sum
  std::vector<AxisImpulse> axes{};       // part of `laws`
  VecX sum() const { return gravity + gyroscopic + laws; }
};
Forces forces_at(const Model& model, const State& state, const Layout& dofs);

}  // namespace aussois
