// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/free_motion.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "mechanics/mechanism.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/tree_terms.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {
namespace {

// What the laws between a dynamic and a moved body change because the latter moves on during the step.
void subtract_moved_anchors(const GeneralisedForce& force, const Layout& dofs, const VecX& v_prescribed,
                            const VecX& v_before, double h, double theta, VecX& laws) {
  const auto couples = [&](const Triplet& e) {
    return row_of(dofs, e.row()) >= 0 && row_of(dofs, e.col()) < 0;
  };
  for (const Triplet& e : force.K)
    if (couples(e)) laws[row_of(dofs, e.row())] -= h * h * theta * e.value() * v_prescribed[e.col()];
  for (const Triplet& e : force.C)
    if (couples(e))
      laws[row_of(dofs, e.row())] -= h * theta * e.value() * (v_prescribed[e.col()] - v_before[e.col()]);
}

// What forces of axes give over a step that is implicit in them (MJ-4); moved bodies go on as they are moved.
std::vector<AxisImpulse> implicit(const Model& model, const State& state, double h, double theta,
                                  std::vector<AxisImpulse> forces) {
  VecX moved = prescribed_velocity(model, state, h);
  for (const BodyId b : model.bodies.ids())
    if (is_dynamic(model.bodies[b])) body_part(moved, b) = body_part(state.v, b);
  for (AxisImpulse& f : forces) {
    const Joint& joint = model.joints[f.joint];
    const JointAxis& axis = joint.axis[f.axis];
    const double speed = axis_speed(joint, f.row, moved), jump = speed - axis_speed(joint, f.row, state.v);
    f.motor *= h;
    f.spring = h * (f.spring - h * theta * axis.stiffness * speed - theta * axis.damping * jump);
    f.D = h * theta * (axis.damping + h * theta * axis.stiffness);
  }
  return forces;
}

// Mass, forces and their derivatives of the coordinates, at q + theta h v for the forces and at the middle of
// the step for the mass (GEN-2); M^ gets h theta C + h^2 theta^2 K through `law_D`.
void add_coordinates(const Model& model, const State& state, const Layout& dofs, double h, double theta,
                     std::vector<Triplet>& mass, std::vector<Triplet>& law_D, VecX& laws, VecX& gravity) {
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    if (is_tree(block)) continue;
    const int row = dofs.coordinates + first_coordinate(model, i);
    const VecX q_i = coordinates(model, state, i), v_i = speeds(model, state, i);
    add_diagonal_block(mass, row, block_mass(model, i, q_i + h / 2 * v_i), 1);
    gravity.segment(row, block.size) = h * block_weight(model, i);
    if (!block.force) continue;
    const CoordinateForce force = block_force(model, i, state.t + theta * h, q_i + theta * h * v_i, v_i);
    laws.segment(row, block.size) += h * force.f;
    add_diagonal_block(law_D, row, force.C, h * theta);
    add_diagonal_block(law_D, row, force.K, h * h * theta * theta);
  }
}

// Where the velocities of the state lead.
struct Ahead {
  State middle{}, there{};  // h / 2 and theta h later
};
// With trees alone; moves the forces on carried bodies to what carries them there.
Ahead carried_ahead(const Model& model, const State& state, double h, double theta, GeneralisedForce& force) {
  if (!carries_bodies(model)) return {};
  Ahead out{retract(model, state, state.v, h / 2), retract(model, state, state.v, theta * h)};
  carry_forces(model, out.there.g, force);
  return out;
}
// What add_coordinates does, of trees (TREE-3) to (TREE-5).
void add_trees(const Model& model, const Layout& dofs, double h, double theta, const Ahead& ahead,
               FreeMotion& out) {
  for (const BlockId i : model.coordinates.ids()) {
    if (!is_tree(model.coordinates[i])) continue;
    const TreeTerms in_the_middle = tree_terms(model, i, ahead.middle);
    const TreeTerms terms = theta == 0.5 ? in_the_middle : tree_terms(model, i, ahead.there);
    out.mass += tree_matrix(terms, in_the_middle.mass, dofs);
    out.gyroscopic_D += tree_matrix(terms, h * theta * terms.C, dofs);
    add_tree_forces(terms, h, dofs, out.gravity, out.gyroscopic);
  }
}

// Writes a matrix of square blocks of 3 along the diagonal, in the order of the rows; zeros take no place. In
// place, since Eigen's sparse matrices are copied where others are moved.
class DiagonalBlocks {
 public:
  DiagonalBlocks(int n, SparseMatrix& matrix) : matrix_(matrix) {
    matrix_.resize(n, n);
    matrix_.resizeNonZeros(3 * n);
  }
  void add(int row, const Mat3& block) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i)
        if (block(i, j) != 0) append(row + i, block(i, j));
      matrix_.outerIndexPtr()[row + j + 1] = count_;
    }
  }
  void add_multiple_of_one(int row, double factor) {
    for (int j = 0; j < 3; ++j) {
      if (factor != 0) append(row + j, factor);
      matrix_.outerIndexPtr()[row + j + 1] = count_;
    }
  }
  // Columns of no block are empty; they come last.
  void finish() {
    matrix_.resizeNonZeros(count_);
    matrix_.finalize();
  }

 private:
  void append(int row, double value) {
    matrix_.innerIndexPtr()[count_] = row;
    matrix_.valuePtr()[count_++] = value;
  }

  SparseMatrix& matrix_;
  int count_ = 0;
};

std::shared_ptr<const MassInverse> shared(std::optional<MassInverse> inverse) {
  return inverse ? std::make_shared<const MassInverse>(std::move(*inverse)) : nullptr;
}

std::shared_ptr<const MassInverse> inverse_of(const SparseMatrix& M, MassScratch* scratch) {
  if (!scratch) return shared(invert_mass(M));
  const std::unique_lock lock(scratch->in_use, std::try_to_lock);
  if (!lock) return shared(invert_mass(M));
  if (scratch->inverse && same_bits(M, scratch->M)) return scratch->inverse;
  scratch->inverse =
      shared(scratch->inverse ? invert_mass(M, scratch->M, *scratch->inverse) : invert_mass(M));
  scratch->M = M;
  return scratch->inverse;
}

}  // namespace

void sum_up(FreeMotion& out, MassScratch* scratch) {
  out.M = out.mass;  // (MJ-4)
  if (out.gyroscopic_D.nonZeros() > 0) out.M += out.gyroscopic_D;
  if (out.law_D.nonZeros() > 0) out.M += out.law_D;
  if (out.turning_D.nonZeros() > 0) out.M += out.turning_D;
  out.M.makeCompressed();
  out.inverse = out.v.size() > 0 ? inverse_of(out.M, scratch) : nullptr;
  sum_up_impulses(out);
}

void sum_up_impulses(FreeMotion& out) {
  VecX impulse = out.laws + out.gravity + out.gyroscopic;
  if (out.turning.size() > 0) impulse += out.turning;
  out.f = out.M * out.v + impulse;  // (MJ-5)
  out.v_free = out.v;
  if (out.v.size() == 0) return;
  if (out.inverse)
    out.v_free += *out.inverse * impulse;  // not M^-1 f: flights are long, and rounding adds up
  else
    out.v_free.setConstant(std::nan(""));  // ends as not_finite in this very step
}

FreeMotion free_motion(const Model& model, const State& state, const Layout& dofs, double h, double theta,
                       MassScratch* scratch) {
  GeneralisedForce force = total_force(model, state, state.t + theta * h);
  FreeMotion out;
  if (has_axis_forces(model))
    out.axes = implicit(
        model, state, h, theta,
        add_axis_forces(model, state, moved_poses(model, state, state.v, h / 2), state.t + theta * h, force));
  const Ahead ahead = carried_ahead(model, state, h, theta, force);
  out.v = out.gravity = out.gyroscopic = out.laws = VecX::Zero(dofs.rows);
  DiagonalBlocks mass(dofs.rows, out.mass), gyroscopic(dofs.rows, out.gyroscopic_D);
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const RigidBody& body = model.bodies[b];
    const Vec3 omega = angular_part(state.v, b), momentum = body.inertia * omega;
    mass.add_multiple_of_one(row, body.mass);
    mass.add(row + 3, body.inertia);
    gyroscopic.add_multiple_of_one(row, 0);
    if (omega.isZero(0))
      gyroscopic.add_multiple_of_one(row + 3, 0);
    else
      gyroscopic.add(row + 3, h * theta * gyroscopic_derivative(body.inertia, omega));
    out.v.segment<6>(row) = body_part(state.v, b);
    out.gravity.segment<3>(row) = h * body.mass * model.gravity;
    out.gyroscopic.segment<3>(row + 3) = -h * omega.cross(momentum);
    out.laws.segment<6>(row) = h * body_part(force.f, b);
  }
  mass.finish();
  gyroscopic.finish();
  out.law_D.resize(dofs.rows, dofs.rows);
  if (!model.coordinates.empty()) {
    std::vector<Triplet> mass_of_them, law_D;
    out.laws.tail(dofs.rows - dofs.coordinates) += h * force.f.tail(dofs.rows - dofs.coordinates);
    out.v.tail(dofs.rows - dofs.coordinates) = state.v.tail(state.q.size());
    add_coordinates(model, state, dofs, h, theta, mass_of_them, law_D, out.laws, out.gravity);
    out.mass += square_matrix(dofs.rows, mass_of_them);
    out.law_D = square_matrix(dofs.rows, law_D);
    add_trees(model, dofs, h, theta, ahead, out);
  }
  if (!force.K.empty() || !force.C.empty()) {
    const SparseMatrix K = square_matrix(dofs.rows, free_entries(force.K, dofs));
    const SparseMatrix C = square_matrix(dofs.rows, free_entries(force.C, dofs));
    out.law_D += SparseMatrix(h * theta * C + h * h * theta * theta * K);
    out.laws -= h * h * theta * (K * out.v);
    subtract_moved_anchors(force, dofs, prescribed_velocity(model, state, h), state.v, h, theta, out.laws);
  }
  if (!force.matrices.empty()) {
    const VecX moves = all_velocities(dofs, out.v, prescribed_velocity(model, state, h));
    SparseMatrix law_D = free_matrix(force.matrices, h * h * theta * theta, h * theta, dofs);
    if (out.law_D.nonZeros() > 0) law_D += out.law_D;
    out.law_D.swap(law_D);
    out.laws -= free_velocities(
        dofs, force_change(force.matrices, h * h * theta * moves, h * theta * (moves - state.v)));
  }
  clear_held(dofs, out.laws);
  sum_up(out, scratch);
  return out;
}

}  // namespace aussois
