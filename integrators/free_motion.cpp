// SPDX-License-Identifier: Apache-2.0
#include "integrators/free_motion.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "lmd/motion_bound.hpp"
#include "mechanics/mechanism.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {
namespace {

SparseMatrix matrix_of(int n, const std::vector<Triplet>& entries) {
  SparseMatrix out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// Entries between dynamic rows, renumbered.
std::vector<Triplet> dynamic_entries(const std::vector<Triplet>& entries, const DofMap& dofs) {
  std::vector<Triplet> out;
  for (const Triplet& e : entries) {
    const int i = row_of(dofs, e.row()), j = row_of(dofs, e.col());
    if (i >= 0 && j >= 0) out.emplace_back(i, j, e.value());
  }
  return out;
}

// What the laws between a dynamic and a moved body change because the latter moves on during the step.
void subtract_moved_anchors(const GeneralisedForce& force, const DofMap& dofs, const VecX& v_prescribed,
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

void add_outer(std::vector<Triplet>& matrix, int row, int column, double factor, const Vec6& a,
               const Vec6& b) {
  if (factor == 0) return;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) matrix.emplace_back(row + i, column + j, factor * a[i] * b[j]);
}

// Spring, damper and effort motor of an axis; directions at the middle of the step (MJT-9).
AxisImpulse add_axis_force(const Model& model, const State& state, const std::vector<SE3>& middle, int j,
                           int i, double t, GeneralisedForce& force) {
  const Joint& joint = model.joints[std::size_t(j)];
  const JointAxis& axis = joint.axis[std::size_t(i)];
  const JointRow row = axis_row(joint, middle, i);
  std::vector<std::pair<int, Vec6>> ends;  // (first velocity, J)
  if (joint.body_a >= 0) ends.emplace_back(6 * joint.body_a, row.J_a);
  if (joint.body_b >= 0) ends.emplace_back(6 * joint.body_b, row.J_b);
  AxisImpulse out{.joint = j, .axis = i, .row = row};
  out.motor = axis.motor.kind == MotorKind::effort ? axis.motor.target(t) : 0;
  out.spring = -axis.stiffness * (joint_coordinate(model, state, j, i) - axis.rest) -
               axis.damping * speed_along(joint, row, state.v);
  for (const auto& [at, J] : ends) {
    force.f.segment<6>(at) += (out.motor + out.spring) * J;
    for (const auto& [with, L] : ends) {
      add_outer(force.K, at, with, axis.stiffness, J, L);
      add_outer(force.C, at, with, axis.damping, J, L);
    }
  }
  return out;
}

bool pushes(const JointAxis& axis) {
  return axis.stiffness != 0 || axis.damping != 0 || axis.motor.kind == MotorKind::effort;
}
bool pushes(const Joint& joint) {
  return std::any_of(joint.axis.begin(), joint.axis.begin() + axis_count(joint.kind),
                     [](const JointAxis& axis) { return pushes(axis); });
}

// What forces of axes give over a step that is implicit in them (MJ-4); moved bodies go on as they are moved.
std::vector<AxisImpulse> implicit(const Model& model, const State& state, double h, double theta,
                                  std::vector<AxisImpulse> forces) {
  VecX moved = prescribed_velocity(model, state, h);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const auto at = 6 * Eigen::Index(b); is_dynamic(model.bodies[b]))
      moved.segment<6>(at) = state.v.segment<6>(at);
  for (AxisImpulse& f : forces) {
    const Joint& joint = model.joints[std::size_t(f.joint)];
    const JointAxis& axis = joint.axis[std::size_t(f.axis)];
    const double speed = speed_along(joint, f.row, moved), jump = speed - speed_along(joint, f.row, state.v);
    f.motor *= h;
    f.spring = h * (f.spring - h * theta * axis.stiffness * speed - theta * axis.damping * jump);
    f.D = h * theta * (axis.damping + h * theta * axis.stiffness);
  }
  return forces;
}

void append(std::vector<Triplet>& out, int at, const MatX& block, double scale) {
  for (int j = 0; j < block.cols(); ++j)
    for (int i = 0; i < block.rows(); ++i)
      if (block(i, j) != 0) out.emplace_back(at + i, at + j, scale * block(i, j));
}

// Mass, forces and their derivatives of the coordinates, at q + theta h v for the forces and at the middle of
// the step for the mass (GEN-2); M^ gets h theta C + h^2 theta^2 K through `law_D`.
void add_coordinates(const Model& model, const State& state, const DofMap& dofs, double h, double theta,
                     std::vector<Triplet>& mass, std::vector<Triplet>& law_D, VecX& laws, VecX& v) {
  for (int i = 0; i < int(model.coordinates.size()); ++i) {
    const Coordinates& block = model.coordinates[std::size_t(i)];
    const int row = dofs.coordinates + first_coordinate(model, i);
    const VecX q_i = coordinates(model, state, i), v_i = speeds(model, state, i);
    append(mass, row, block_mass(model, i, q_i + h / 2 * v_i), 1);
    v.segment(row, block.size) = v_i;
    if (!block.force) continue;
    const CoordinateForce force = block_force(model, i, state.t + theta * h, q_i + theta * h * v_i, v_i);
    laws.segment(row, block.size) += h * force.f;
    append(law_D, row, force.C, h * theta);
    append(law_D, row, force.K, h * h * theta * theta);
  }
}

// The derivative of omega x J omega with respect to omega.
Mat3 gyroscopic_derivative(const Mat3& J, const Vec3& omega) {
  return skew(omega) * J - skew(J * omega);
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

double speed_along(const Joint& joint, const JointRow& row, const VecX& v) {
  double out = 0;
  if (joint.body_a >= 0) out += row.J_a.dot(v.segment<6>(6 * joint.body_a));
  if (joint.body_b >= 0) out += row.J_b.dot(v.segment<6>(6 * joint.body_b));
  return out;
}

DofMap dof_map(const Model& model) {
  DofMap dofs;
  for (const RigidBody& body : model.bodies) {
    dofs.first.push_back(is_dynamic(body) ? dofs.rows : -1);
    if (is_dynamic(body)) dofs.rows += 6;
  }
  dofs.coordinates = dofs.rows;
  dofs.rows += first_coordinate(model, int(model.coordinates.size()));
  return dofs;
}

int row_of(const DofMap& dofs, Eigen::Index velocity) {
  const auto body = std::size_t(velocity / 6);
  if (body >= dofs.first.size()) return dofs.coordinates + int(velocity) - 6 * int(dofs.first.size());
  return dofs.first[body] < 0 ? -1 : dofs.first[body] + int(velocity % 6);
}

VecX prescribed_velocity(const Model& model, const State& state, double h) {
  VecX v = VecX::Zero(state.v.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto* motion = std::get_if<Prescribed>(&model.bodies[b].motion);
    if (!motion) continue;
    const SE3 next = evaluate(motion->path, state.t + h).pose;
    v.segment<3>(6 * Eigen::Index(b)) = (next.p - state.g[b].p) / h;
    v.segment<3>(6 * Eigen::Index(b) + 3) = log_so3((state.g[b].R.conjugate() * next.R).normalized()) / h;
  }
  return v;
}

VecX all_velocities(const DofMap& dofs, const VecX& v, const VecX& v_prescribed) {
  VecX all = v_prescribed;
  for (std::size_t b = 0; b < dofs.first.size(); ++b)
    if (dofs.first[b] >= 0) all.segment<6>(6 * Eigen::Index(b)) = v.segment<6>(dofs.first[b]);
  all.tail(dofs.rows - dofs.coordinates) = v.tail(dofs.rows - dofs.coordinates);
  return all;
}

VecX free_velocities(const DofMap& dofs, const VecX& all) {
  VecX v(dofs.rows);
  for (std::size_t b = 0; b < dofs.first.size(); ++b)
    if (dofs.first[b] >= 0) v.segment<6>(dofs.first[b]) = all.segment<6>(6 * Eigen::Index(b));
  v.tail(dofs.rows - dofs.coordinates) = all.tail(dofs.rows - dofs.coordinates);
  return v;
}

std::vector<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time) {
  std::vector<SE3> g(state.g.size());
  for (std::size_t b = 0; b < g.size(); ++b) {
    const auto at = 6 * Eigen::Index(b);
    if (const auto* prescribed = std::get_if<Prescribed>(&model.bodies[b].motion))
      g[b] = evaluate(prescribed->path, state.t + time).pose;
    else
      g[b] = pose_at({.g = state.g[b], .v = v.segment<3>(at), .omega = v.segment<3>(at + 3)}, time);
  }
  return g;
}

std::vector<AxisImpulse> add_axis_forces(const Model& model, const State& state,
                                         const std::vector<SE3>& middle, double t, GeneralisedForce& force) {
  std::vector<AxisImpulse> out;
  for (int j = 0; j < int(model.joints.size()); ++j)
    for (int i = 0; i < axis_count(model.joints[std::size_t(j)].kind); ++i)
      if (pushes(model.joints[std::size_t(j)].axis[std::size_t(i)]))
        out.push_back(add_axis_force(model, state, middle, j, i, t, force));
  return out;
}

std::vector<AxisImpulse> trapezoid(double h, std::vector<AxisImpulse> start,
                                   const std::vector<AxisImpulse>& end) {
  start.insert(start.end(), end.begin(), end.end());
  for (AxisImpulse& f : start) f.motor *= h / 2, f.spring *= h / 2;
  return start;
}

FreeMotion free_motion(const Model& model, const State& state, const DofMap& dofs, double h, double theta,
                       MassScratch* scratch) {
  GeneralisedForce force = total_force(model, state, state.t + theta * h);
  FreeMotion out;
  if (std::ranges::any_of(model.joints, [](const Joint& joint) { return pushes(joint); }))
    out.axes = implicit(
        model, state, h, theta,
        add_axis_forces(model, state, moved_poses(model, state, state.v, h / 2), state.t + theta * h, force));
  out.v = out.gravity = out.gyroscopic = out.laws = VecX::Zero(dofs.rows);
  DiagonalBlocks mass(dofs.rows, out.mass), gyroscopic(dofs.rows, out.gyroscopic_D);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const RigidBody& body = model.bodies[b];
    const Vec3 omega = state.v.segment<3>(6 * Eigen::Index(b) + 3), momentum = body.inertia * omega;
    mass.add_multiple_of_one(row, body.mass);
    mass.add(row + 3, body.inertia);
    gyroscopic.add_multiple_of_one(row, 0);
    if (omega.isZero(0))
      gyroscopic.add_multiple_of_one(row + 3, 0);
    else
      gyroscopic.add(row + 3, h * theta * gyroscopic_derivative(body.inertia, omega));
    out.v.segment<6>(row) = state.v.segment<6>(6 * Eigen::Index(b));
    out.gravity.segment<3>(row) = h * body.mass * model.gravity;
    out.gyroscopic.segment<3>(row + 3) = -h * omega.cross(momentum);
    out.laws.segment<6>(row) = h * force.f.segment<6>(6 * Eigen::Index(b));
  }
  mass.finish();
  gyroscopic.finish();
  out.law_D.resize(dofs.rows, dofs.rows);
  if (!model.coordinates.empty()) {
    std::vector<Triplet> mass_of_them, law_D;
    out.laws.tail(dofs.rows - dofs.coordinates) += h * force.f.tail(dofs.rows - dofs.coordinates);
    add_coordinates(model, state, dofs, h, theta, mass_of_them, law_D, out.laws, out.v);
    out.mass += matrix_of(dofs.rows, mass_of_them);
    out.law_D = matrix_of(dofs.rows, law_D);
  }
  if (!force.K.empty() || !force.C.empty()) {
    const SparseMatrix K = matrix_of(dofs.rows, dynamic_entries(force.K, dofs));
    const SparseMatrix C = matrix_of(dofs.rows, dynamic_entries(force.C, dofs));
    out.law_D += SparseMatrix(h * theta * C + h * h * theta * theta * K);
    out.laws -= h * h * theta * (K * out.v);
    subtract_moved_anchors(force, dofs, prescribed_velocity(model, state, h), state.v, h, theta, out.laws);
  }
  sum_up(out, scratch);
  return out;
}

FreeMotion with_gyroscopic(const Model& model, const DofMap& dofs, double h, GyroscopicTerm term,
                           const VecX& v_guess, FreeMotion free) {
  std::vector<Triplet> entries;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const Mat3& J = model.bodies[b].inertia;
    const Vec3 omega = free.v.segment<3>(row + 3);
    if (term == GyroscopicTerm::start) {  // (PMI-2)
      const Mat3 D = -skew(J * omega);
      free.gyroscopic.segment<3>(row + 3) = -h * D * omega;
      add_block(entries, row + 3, row + 3, h / 2 * D);
    } else {  // (PMI-3)
      const Vec3 middle = (omega + v_guess.segment<3>(row + 3)) / 2, momentum = J * middle;
      const Mat3 D = skew(middle) * J - skew(momentum);
      free.gyroscopic.segment<3>(row + 3) = -h * (middle.cross(momentum) + D * (omega - middle));
      add_block(entries, row + 3, row + 3, h / 2 * D);
    }
  }
  free.gyroscopic_D = matrix_of(dofs.rows, entries);
  sum_up(free);
  return free;
}

Forces forces_at(const Model& model, const State& state, const DofMap& dofs) {
  GeneralisedForce force = total_force(model, state, state.t);
  Forces out;
  out.axes = add_axis_forces(model, state, state.g, state.t, force);
  out.gravity = out.gyroscopic = VecX::Zero(dofs.rows);
  out.laws = free_velocities(dofs, force.f);
  std::vector<Triplet> mass, K = dynamic_entries(force.K, dofs), C = dynamic_entries(force.C, dofs);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const RigidBody& body = model.bodies[b];
    const Vec3 omega = state.v.segment<3>(6 * Eigen::Index(b) + 3), momentum = body.inertia * omega;
    add_block(mass, row, row, body.mass * Mat3::Identity());
    add_block(mass, row + 3, row + 3, body.inertia);
    add_block(C, row + 3, row + 3, gyroscopic_derivative(body.inertia, omega));
    out.gravity.segment<3>(row) = body.mass * model.gravity;
    out.gyroscopic.segment<3>(row + 3) = -omega.cross(momentum);
  }
  for (int i = 0; i < int(model.coordinates.size()); ++i) {
    const Coordinates& block = model.coordinates[std::size_t(i)];
    const int row = dofs.coordinates + first_coordinate(model, i);
    const VecX q = coordinates(model, state, i), v = speeds(model, state, i);
    append(mass, row, block_mass(model, i, q), 1);
    if (!block.force) continue;
    const CoordinateForce own = block_force(model, i, state.t, q, v);
    out.laws.segment(row, block.size) += own.f;
    append(C, row, own.C, 1);
    append(K, row, own.K, 1);
  }
  out.mass = matrix_of(dofs.rows, mass);
  out.K = matrix_of(dofs.rows, K);
  out.C = matrix_of(dofs.rows, C);
  return out;
}

const char* to_string(GroupUpdate update) {
  switch (update) {
    case GroupUpdate::exponential:
      return "exponential";
    case GroupUpdate::cayley:
      return "cayley";
    case GroupUpdate::screw:
      return "screw";
  }
  return "?";
}

GroupUpdate group_update(const std::string& name) {
  for (const GroupUpdate update : {GroupUpdate::exponential, GroupUpdate::cayley, GroupUpdate::screw})
    if (name == to_string(update)) return update;
  throw std::invalid_argument("group update = " + name + " must be exponential, cayley or screw");
}

VecX path_velocity(GroupUpdate update, const Model& model, const State& state, const VecX& v, double h) {
  if (update == GroupUpdate::exponential) return v;  // (LIE-1)
  VecX out = v;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto at = 6 * Eigen::Index(b);
    const Vec3 omega = v.segment<3>(at + 3);
    const double half = h / 2 * omega.norm();
    if (!is_dynamic(model.bodies[b]) || half == 0) continue;
    if (update == GroupUpdate::cayley) {
      out.segment<3>(at + 3) *= std::atan(half) / half;  // (LIE-2)
    } else {
      const Vec3 axis = state.g[b].R * omega.normalized(), along = axis * axis.dot(v.segment<3>(at));
      out.segment<3>(at) = along + stumpff(1, half * half) * (v.segment<3>(at) - along);  // (LIE-3)
    }
  }
  return out;
}

}  // namespace aussois
