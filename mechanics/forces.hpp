// SPDX-License-Identifier: Apache-2.0
// What pushes bodies and coordinates between contacts: gravity, gyroscopic torques, laws, axes of joints.
#pragma once

#include "mechanics/layout.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// J . v of a row, with v in the places of State::v.
double speed_along(const Joint& joint, const JointRow& row, const VecX& v);

/// What a spring and damper and an effort motor give along an axis of a joint: an impulse over a step
/// [N s, N m s], or a force [N, N m].
struct AxisImpulse {
  int joint = -1, axis = 0;
  JointRow row{};
  double motor = 0;
  double spring = 0;  // and damper, if the velocity does not change
  double D = 0;       // what it loses of J times the change of the velocity [N s^2/m, N m s^2]
};

/// Adds springs, dampers and effort motors of the joints' axes at time t, with directions at the poses
/// `middle` (MJT-9), and tells them one by one.
std::vector<AxisImpulse> add_axis_forces(const Model& model, const State& state,
                                         const std::vector<SE3>& middle, double t, GeneralisedForce& force);
/// Whether any axis of the model pushes so.
bool has_axis_forces(const Model& model);
/// Impulses of forces that are these at the ends of a step.
std::vector<AxisImpulse> trapezoid(double h, std::vector<AxisImpulse> start,
                                   const std::vector<AxisImpulse>& end);

/// The derivative of the torque omega x J omega with respect to omega, body frame.
Mat3 gyroscopic_derivative(const Mat3& J, const Vec3& omega);

/// A sparse matrix of n rows and columns with these entries, summed where they meet.
SparseMatrix square_matrix(int n, const std::vector<Triplet>& entries);
/// Those between free rows, renumbered.
std::vector<Triplet> free_entries(const std::vector<Triplet>& entries, const Layout& dofs);
/// Appends `scale` times a block on the diagonal, zeros left out.
void add_block(std::vector<Triplet>& matrix, int at, const MatX& block, double scale);

/// All forces at a state and at its own time, rows of the problem; joint axes and coordinates included.
struct Forces {
  SparseMatrix mass{};                   // at the state's coordinates
  VecX gravity{}, gyroscopic{}, laws{};  // [N, N m]
  SparseMatrix K{}, C{};                 // -df/dq and -df/dv of the sum
  std::vector<AxisImpulse> axes{};       // part of `laws`
  VecX sum() const { return gravity + gyroscopic + laws; }
};
Forces forces_at(const Model& model, const State& state, const Layout& dofs);

}  // namespace aussois
