// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/conserving_forces.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "mechanics/mechanism.hpp"
#include "mechanics/motion.hpp"

namespace aussois {
namespace {

constexpr double kMiddle = 0.5;
constexpr double kRounding = 4e-16;  // of a potential: no change below it is known
constexpr double kNoMotion = 1e-12;  // of the kinetic energy, for what is left without a rigid motion

bool acts_on_what_is_moved(const Model& model, const GeneralisedForce& force) {
  for (const BodyId b : model.bodies.ids())
    if (is_moved(model.bodies[b]) && !body_part(force.f, b).isZero(0)) return true;
  return false;
}

// Which entries of State::v a law acts on; if it is internal, all of a body or point.
std::vector<char> acts_on(const Model& model, const ForceLaw& law, const GeneralisedForce& force) {
  std::vector<char> out(std::size_t(force.f.size()), 0);
  for (Eigen::Index k = 0; k < force.f.size(); ++k) out[std::size_t(k)] = force.f[k] != 0;
  for (const Triplet& e : force.K) out[std::size_t(e.row())] = 1;
  for (const ForceMatrix& m : force.matrices)
    for (const int entry : m.pattern->entry)
      for (int k = 0; k < m.pattern->size; ++k) out[std::size_t(m.first + entry + k)] = 1;
  const auto fill = [&](int first, int count) {
    const auto begin = out.begin() + first;
    if (std::any_of(begin, begin + count, [](char one) { return one != 0; })) std::fill_n(begin, count, 1);
  };
  if (!law.internal) return out;
  for (const BodyId b : model.bodies.ids()) fill(first_velocity(b), 6);
  for (const BlockId i : model.coordinates.ids())
    for (std::size_t k = 0; k < model.coordinates[i].points.size(); ++k)
      fill(first_speed(model, i) + 3 * int(k), 3);
  return out;
}

// The six velocities of a rigid motion, as columns in the rows of the problem, of what a law acts on.
MatX rigid_motions(const Model& model, const State& state, const Layout& dofs,
                   const std::vector<char>& moved) {
  MatX out = MatX::Zero(dofs.rows, 6);
  const auto add_point = [&](int row, const Vec3& at) {
    out.block<3, 3>(row, 0).setIdentity();
    out.block<3, 3>(row, 3) = -skew(at);
  };
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0 || !moved[std::size_t(first_velocity(b))]) continue;
    add_point(row, state.g[b].p);
    out.block<3, 3>(row + 3, 3) = state.g[b].R.toRotationMatrix().transpose();
  }
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    const VecX q = coordinates(model, state, i);
    for (std::size_t k = 0; k < block.points.size(); ++k) {
      const int at = first_speed(model, i) + 3 * int(k);
      if (moved[std::size_t(at)]) add_point(any_row_of(dofs, at), point_place(block, q, k));
    }
  }
  return out;
}

// The part of velocities that is no rigid motion, by kinetic energy: its momenta vanish.
VecX without_rigid_motion(const MatX& motions, const SparseMatrix& mass, const VecX& v) {
  const MatX momenta = mass * motions;
  const Mat6 inertia = motions.transpose() * momenta;
  return v - motions * inertia.completeOrthogonalDecomposition().solve(momenta.transpose() * v);
}

// Is nothing that a law acts on fixed or held?
bool is_free(const Layout& dofs, const std::vector<char>& moved) {
  for (std::size_t k = 0; k < moved.size(); ++k)
    if (moved[k] && row_of(dofs, Eigen::Index(k)) < 0) return false;
  return true;
}

struct Path {
  State middle{}, end{};
};

// What a law lacks at the middle so that its work is the change of its potential (PMI-10), (PMI-11).
VecX missing_impulse(const StepSetting& setting, const ForceLaw& law, const State& start, const Path& path,
                     const SparseMatrix& mass, double h) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  State still = path.middle;
  still.v.setZero();
  GeneralisedForce force{.f = VecX::Zero(start.v.size())};
  law.add_to(model, still, still.t, force);
  const double before = law.potential(model, start, start.t),
               after = law.potential(model, path.end, path.end.t),
               missing = before - after - h * force.f.dot(path.middle.v);
  VecX none = VecX::Zero(dofs.rows);
  if (acts_on_what_is_moved(model, force) ||
      !(std::abs(missing) > kRounding * (std::abs(before) + std::abs(after))))
    return none;
  const std::vector<char> moved = acts_on(model, law, force);
  VecX moves = path.middle.v;
  for (Eigen::Index k = 0; k < moves.size(); ++k)
    if (!moved[std::size_t(k)]) moves[k] = 0;
  const VecX v = free_velocities(dofs, moves);
  VecX along = mass * (law.internal && is_free(dofs, moved)
                           ? without_rigid_motion(rigid_motions(model, path.middle, dofs, moved), mass, v)
                           : v);
  clear_held(dofs, along);
  const double power = v.dot(along);
  return power > kNoMotion * v.dot(mass * v) ? VecX(missing / power * along) : none;
}

// Of torques taken half-way of Cayley's turns, so that they change the momentum in space by as much (PMI-12).
void stretch_torques(const Layout& dofs, const VecX& mean, double h, VecX& impulse) {
  for (const int row : dofs.first) {
    if (row < 0) continue;
    const Vec3 omega = mean.segment<3>(row + 3), torque = impulse.segment<3>(row + 3);
    const double half = h / 2 * omega.norm();
    if (half == 0) continue;
    const Vec3 along = omega.dot(torque) / omega.squaredNorm() * omega;
    impulse.segment<3>(row + 3) = along + std::sqrt(1 + half * half) * (torque - along);
  }
}

// h f of all forces, and D = h/2 C + h^2/4 K (MJ-4); `change` of the velocities over the step.
MiddleForces middle_forces(const StepSetting& setting, const State& middle, const VecX& change, double h) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  const double of_C = kMiddle * h, of_K = of_C * of_C;
  GeneralisedForce force = total_force(model, middle, middle.t);
  MiddleForces out{.axes = add_axis_forces(model, middle, middle.g, middle.t, force)};
  out.laws = h * free_velocities(dofs, force.f);
  std::vector<Triplet> D;
  for (const auto& [entries, scale] : {std::pair(&force.K, of_K), std::pair(&force.C, of_C)})
    for (const Triplet& e : free_entries(*entries, dofs)) D.emplace_back(e.row(), e.col(), scale * e.value());
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    if (!block.force) continue;
    const int row = dofs.coordinates + first_coordinate(model, i);
    const CoordinateForce own =
        block_force(model, i, middle.t, coordinates(model, middle, i), speeds(model, middle, i));
    out.laws.segment(row, block.size) += h * own.f;
    add_diagonal_block(D, row, own.K, of_K);
    add_diagonal_block(D, row, own.C, of_C);
  }
  out.law_D = square_matrix(dofs.rows, D);
  if (!force.matrices.empty()) out.law_D += free_matrix(force.matrices, of_K, of_C, dofs);
  const VecX all_change = all_velocities(dofs, change, VecX::Zero(middle.v.size()));
  for (AxisImpulse& a : out.axes) {
    const JointAxis& axis = model.joints[a.joint].axis[a.axis];
    a.motor *= h;
    a.D = of_C * axis.damping + of_K * axis.stiffness;
    a.spring = h * a.spring + a.D * axis_speed(model.joints[a.joint], a.row, all_change);
  }
  return out;
}

}  // namespace

MiddleForces conserving_forces(const StepSetting& setting, const State& start, const SparseMatrix& mass,
                               const MiddleMotion& motion, double h) {
  const Model& model = setting.model;
  const VecX moves = all_velocities(setting.dofs, motion.mean, motion.v_prescribed),
             along = path_velocity(setting.options.update, model, start, moves, h);
  const Path path{state_after(model, start, along, moves, h / 2), state_after(model, start, along, moves, h)};
  const VecX change = 2 * (motion.mean - motion.v);
  MiddleForces out = middle_forces(setting, path.middle, change, h);
  out.missing = motion.missing;
  if (out.missing.size() == 0) {
    out.missing = VecX::Zero(setting.dofs.rows);
    for (const ForceLaw& law : model.forces)
      if (law.passive && law.potential) out.missing += missing_impulse(setting, law, start, path, mass, h);
  }
  out.laws += out.missing;
  if (setting.options.update == GroupUpdate::cayley) stretch_torques(setting.dofs, motion.mean, h, out.laws);
  out.laws += out.law_D * change;
  clear_held(setting.dofs, out.laws);
  return out;
}

}  // namespace aussois
