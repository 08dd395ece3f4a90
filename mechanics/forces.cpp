// SPDX-License-Identifier: Apache-2.0
#include "mechanics/forces.hpp"

#include <algorithm>

#include "mechanics/mechanism.hpp"
#include "mechanics/tree_terms.hpp"

namespace aussois {
namespace {

// Spring, damper and effort motor of an axis; directions at the middle of the step (MJT-9).
AxisImpulse add_axis_force(const Model& model, const State& state, const PerBody<SE3>& middle, JointId j,
                           int i, double t, GeneralisedForce& force) {
  const Joint& joint = model.joints[j];
  const JointAxis& axis = joint.axis[i];
  const JointRow row = axis_row(model, middle, j, i);
  std::vector<std::pair<int, double>> along = row.others;  // (entry of State::v, J)
  for (const auto& [body, J] : {std::pair(joint.body_a, &row.J_a), std::pair(joint.body_b, &row.J_b)})
    for (int k = 0; k < 6 && body && !is_carried(model.bodies[body]); ++k)
      along.emplace_back(first_velocity(body) + k, (*J)[k]);
  AxisImpulse out{.joint = j, .axis = i, .row = row};
  out.motor = axis.motor.kind == MotorKind::effort ? axis.motor.target(t) : 0;
  out.spring = -axis.stiffness * (joint_coordinate(model, state, j, i) - axis.rest) -
               axis.damping * axis_speed(joint, row, state.v);
  for (const auto& [at, J] : along) {
    force.f[at] += (out.motor + out.spring) * J;
    for (const auto& [with, L] : along) {
      if (axis.stiffness != 0) force.K.emplace_back(at, with, axis.stiffness * J * L);
      if (axis.damping != 0) force.C.emplace_back(at, with, axis.damping * J * L);
    }
  }
  return out;
}

bool pushes(const JointAxis& axis) {
  return axis.stiffness != 0 || axis.damping != 0 || axis.motor.kind == MotorKind::effort;
}

}  // namespace

bool has_axis_forces(const Model& model) {
  return std::ranges::any_of(model.joints, [](const Joint& joint) {
    return std::any_of(joint.axis.begin(), joint.axis.begin() + axis_count(joint.kind), pushes);
  });
}

std::vector<AxisImpulse> add_axis_forces(const Model& model, const State& state, const PerBody<SE3>& middle,
                                         double t, GeneralisedForce& force) {
  std::vector<AxisImpulse> out;
  for (const JointId j : model.joints.ids())
    for (int i = 0; i < axis_count(model.joints[j].kind); ++i)
      if (pushes(model.joints[j].axis[i]))
        out.push_back(add_axis_force(model, state, middle, j, i, t, force));
  return out;
}

std::vector<AxisImpulse> trapezoidal_impulses(double h, std::vector<AxisImpulse> start,
                                              const std::vector<AxisImpulse>& end) {
  start.insert(start.end(), end.begin(), end.end());
  for (AxisImpulse& f : start) f.motor *= h / 2, f.spring *= h / 2;
  return start;
}

Mat3 gyroscopic_derivative(const Mat3& J, const Vec3& omega) {
  return skew(omega) * J - skew(J * omega);
}

SparseMatrix square_matrix(int n, const std::vector<Triplet>& entries) {
  SparseMatrix out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

std::vector<Triplet> free_entries(const std::vector<Triplet>& entries, const Layout& dofs) {
  std::vector<Triplet> out;
  for (const Triplet& e : entries) {
    const int i = row_of(dofs, e.row()), j = row_of(dofs, e.col());
    if (i >= 0 && j >= 0) out.emplace_back(i, j, e.value());
  }
  return out;
}

void add_diagonal_block(std::vector<Triplet>& out, int at, const MatX& block, double scale) {
  for (int j = 0; j < block.cols(); ++j)
    for (int i = 0; i < block.rows(); ++i)
      if (block(i, j) != 0) out.emplace_back(at + i, at + j, scale * block(i, j));
}

void add_diagonal_block(std::vector<Triplet>& out, int at, const SparseMatrix& block, double scale) {
  for (int j = 0; j < block.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(block, j); it; ++it)
      if (it.value() != 0) out.emplace_back(at + it.row(), at + j, scale * it.value());
}

void add_body_masses(const Model& model, const Layout& dofs, std::vector<Triplet>& matrix) {
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    add_block(matrix, row, row, model.bodies[b].mass * Mat3::Identity());
    add_block(matrix, row + 3, row + 3, model.bodies[b].inertia);
  }
}

namespace {

std::vector<TreeTerms> all_tree_terms(const Model& model, const State& state) {
  std::vector<TreeTerms> out;
  for (const BlockId i : model.coordinates.ids())
    if (is_tree(model.coordinates[i])) out.push_back(tree_terms(model, i, state));
  return out;
}

SparseMatrix mass_matrix(const Model& model, const State& state, const std::vector<TreeTerms>& trees,
                         const Layout& dofs) {
  std::vector<Triplet> mass;
  add_body_masses(model, dofs, mass);
  for (const BlockId i : model.coordinates.ids())
    if (!is_tree(model.coordinates[i]))
      add_diagonal_block(mass, dofs.coordinates + first_coordinate(model, i),
                         block_mass(model, i, coordinates(model, state, i)), 1);
  SparseMatrix out = square_matrix(dofs.rows, mass);
  for (const TreeTerms& terms : trees) out += tree_matrix(terms, terms.mass, dofs);
  return out;
}

}  // namespace

SparseMatrix mass_matrix(const Model& model, const State& state, const Layout& dofs) {
  return mass_matrix(model, state, all_tree_terms(model, state), dofs);
}

Forces forces_at(const Model& model, const State& state, const Layout& dofs) {
  GeneralisedForce force = total_force(model, state, state.t);
  Forces out;
  out.axes = add_axis_forces(model, state, state.g, state.t, force);
  carry_forces(model, state.g, force);
  out.gravity = out.gyroscopic = VecX::Zero(dofs.rows);
  out.laws = free_velocities(dofs, force.f);
  clear_held(dofs, out.laws);
  std::vector<Triplet> K = free_entries(force.K, dofs), C = free_entries(force.C, dofs);
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const RigidBody& body = model.bodies[b];
    const Vec3 omega = angular_part(state.v, b), momentum = body.inertia * omega;
    add_block(C, row + 3, row + 3, gyroscopic_derivative(body.inertia, omega));
    out.gravity.segment<3>(row) = body.mass * model.gravity;
    out.gyroscopic.segment<3>(row + 3) = -omega.cross(momentum);
  }
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    const int row = dofs.coordinates + first_coordinate(model, i);
    const VecX q = coordinates(model, state, i), v = speeds(model, state, i);
    out.gravity.segment(row, block.size) = block_weight(model, i);
    if (!block.force) continue;
    const CoordinateForce own = block_force(model, i, state.t, q, v);
    out.laws.segment(row, block.size) += own.f;
    add_diagonal_block(C, row, own.C, 1);
    add_diagonal_block(K, row, own.K, 1);
  }
  const std::vector<TreeTerms> trees = all_tree_terms(model, state);
  out.mass = mass_matrix(model, state, trees, dofs);
  out.K = square_matrix(dofs.rows, K);
  out.C = square_matrix(dofs.rows, C);
  for (const TreeTerms& terms : trees) {
    out.C += tree_matrix(terms, terms.C, dofs);
    add_tree_forces(terms, 1, dofs, out.gravity, out.gyroscopic);
  }
  if (!force.matrices.empty()) {
    out.K += free_matrix(force.matrices, 1, 0, dofs);
    out.C += free_matrix(force.matrices, 0, 1, dofs);
  }
  return out;
}

}  // namespace aussois
