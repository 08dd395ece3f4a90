// SPDX-License-Identifier: Apache-2.0
#include "integrators/free_motion.hpp"

#include <cmath>
#include <variant>

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
    const int i = dofs.first[std::size_t(e.row() / 6)], j = dofs.first[std::size_t(e.col() / 6)];
    if (i >= 0 && j >= 0) out.emplace_back(i + e.row() % 6, j + e.col() % 6, e.value());
  }
  return out;
}

// What the laws between a dynamic and a moved body change because the latter moves on during the step.
void subtract_moved_anchors(const GeneralisedForce& force, const DofMap& dofs, const VecX& v_prescribed,
                            const VecX& v_before, double h, double theta, VecX& laws) {
  const auto couples = [&](const Triplet& e) {
    return dofs.first[std::size_t(e.row() / 6)] >= 0 && dofs.first[std::size_t(e.col() / 6)] < 0;
  };
  const auto row = [&](const Triplet& e) { return dofs.first[std::size_t(e.row() / 6)] + e.row() % 6; };
  for (const Triplet& e : force.K)
    if (couples(e)) laws[row(e)] -= h * h * theta * e.value() * v_prescribed[e.col()];
  for (const Triplet& e : force.C)
    if (couples(e)) laws[row(e)] -= h * theta * e.value() * (v_prescribed[e.col()] - v_before[e.col()]);
}

}  // namespace

DofMap dof_map(const Model& model) {
  DofMap dofs;
  for (const RigidBody& body : model.bodies) {
    dofs.first.push_back(is_dynamic(body) ? dofs.rows : -1);
    if (is_dynamic(body)) dofs.rows += 6;
  }
  return dofs;
}

VecX prescribed_velocity(const Model& model, const State& state, double h) {
  VecX v = VecX::Zero(6 * Eigen::Index(model.bodies.size()));
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto* motion = std::get_if<Prescribed>(&model.bodies[b].motion);
    if (!motion) continue;
    const SE3 next = evaluate(motion->path, state.t + h).pose;
    v.segment<3>(6 * Eigen::Index(b)) = (next.p - state.g[b].p) / h;
    v.segment<3>(6 * Eigen::Index(b) + 3) = log_so3((state.g[b].R.conjugate() * next.R).normalized()) / h;
  }
  return v;
}

FreeMotion free_motion(const Model& model, const State& state, const DofMap& dofs, double h, double theta) {
  const auto bodies = Eigen::Index(model.bodies.size());
  GeneralisedForce force{.f = VecX::Zero(6 * bodies), .K = {}, .C = {}};
  for (const ForceLaw& law : model.forces) law.add_to(model, state, state.t + theta * h, force);

  FreeMotion out;
  out.v = out.gravity = out.gyroscopic = out.laws = VecX::Zero(dofs.rows);
  std::vector<Triplet> mass, gyroscopic;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const RigidBody& body = model.bodies[b];
    const Vec3 omega = state.v.segment<3>(6 * Eigen::Index(b) + 3), momentum = body.inertia * omega;
    add_block(mass, row, row, body.mass * Mat3::Identity());
    add_block(mass, row + 3, row + 3, body.inertia);
    add_block(gyroscopic, row + 3, row + 3, skew(omega) * body.inertia - skew(momentum));
    out.v.segment<6>(row) = state.v.segment<6>(6 * Eigen::Index(b));
    out.gravity.segment<3>(row) = h * body.mass * model.gravity;
    out.gyroscopic.segment<3>(row + 3) = -h * omega.cross(momentum);
    out.laws.segment<6>(row) = h * force.f.segment<6>(6 * Eigen::Index(b));
  }
  out.mass = matrix_of(dofs.rows, mass);
  out.gyroscopic_D = h * theta * matrix_of(dofs.rows, gyroscopic);
  const SparseMatrix K = matrix_of(dofs.rows, dynamic_entries(force.K, dofs));
  const SparseMatrix C = matrix_of(dofs.rows, dynamic_entries(force.C, dofs));
  out.law_D = h * theta * C + h * h * theta * theta * K;
  out.laws -= h * h * theta * (K * out.v);
  subtract_moved_anchors(force, dofs, prescribed_velocity(model, state, h), state.v, h, theta, out.laws);
  out.M = out.mass + out.gyroscopic_D + out.law_D;                  // (MJ-4)
  out.f = out.M * out.v + out.laws + out.gravity + out.gyroscopic;  // (MJ-5)
  out.v_free = out.v;
  if (dofs.rows > 0) {
    out.M.makeCompressed();
    if (const std::optional<MassInverse> inverse = invert_mass(out.M))
      out.v_free = *inverse * out.f;
    else
      out.v_free.setConstant(std::nan(""));  // ends as not_finite in this very step
  }
  return out;
}

}  // namespace aussois
