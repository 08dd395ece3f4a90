// SPDX-License-Identifier: Apache-2.0
#include "integrators/events/touching.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "lmd/contact_kinematics.hpp"
#include "lmd/motion_bound.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/tree.hpp"
#include "mechanics/tree_terms.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr double kStabilisation = 10;  // [1/s]; drift falls as exp(-10 t), slower than anything of interest
constexpr double kRoom = 1e-9;         // inside the cone of friction by this part is inside [-]
constexpr double kRank = 1e-10;        // of W: directions that redundant contacts share [-]
constexpr double kGlide =
    1e-3;  // of the time in which a body turns by 1 rad or a coordinate moves by 1: for differences
constexpr double kLargestGlide = 1e-3;  // [s]

// Velocities of rows given in the places of State::v, split into what is free and what moves by itself.
Touch touch_of(const StepSetting& setting, const State& state, const MatX& J, const VecX& rate, Law law,
               double gap, double restitution, std::optional<int> slot) {
  const Layout& dofs = setting.dofs;
  Touch out{.slot = slot, .law = law, .restitution = restitution, .gap = gap};
  out.N = MatX::Zero(dofs.rows, J.rows());
  for (Eigen::Index k = 0; k < J.cols(); ++k)
    if (const int row = row_of(dofs, k); row >= 0) out.N.row(row) = J.col(k).transpose();
  out.u = J * state.v + rate;
  out.bias = VecX::Zero(J.rows());
  return out;
}

void put(MatX& J, Eigen::Index row, BodyId body, const Vec6& values) {
  if (body) J.row(row).segment<6>(first_velocity(body)) = values.transpose();
}

// Stops and dry friction of the axes of all joints.
void add_axes(const StepSetting& setting, const State& state, std::vector<Touch>& out) {
  const Model& model = setting.model;
  const VecX none = VecX::Zero(1);
  for (const JointId j : model.joints.ids()) {
    const Joint& joint = model.joints[j];
    for (int i = 0; i < axis_count(joint.kind); ++i) {
      const JointAxis& axis = joint.axis[i];
      if (axis.lower == -kInf && axis.upper == kInf && axis.friction == 0) continue;
      const JointRow row = axis_row(model, state.g, j, i);
      MatX J = MatX::Zero(1, state.v.size());
      put(J, 0, joint.body_a, row.J_a);
      put(J, 0, joint.body_b, row.J_b);
      for (const auto& [entry, factor] : row.others) J(0, entry) += factor;
      const double q = joint_coordinate(model, state, j, i);
      const auto slot = [&](AxisRow of) { return slot_of({.joint = j, .axis = i, .row = of}); };
      if (axis.lower > -kInf)
        out.push_back(touch_of(setting, state, J, none, unilateral(), q - axis.lower, axis.restitution,
                               slot(AxisRow::lower_stop)));
      if (axis.upper < kInf)
        out.push_back(touch_of(setting, state, -J, none, unilateral(), axis.upper - q, axis.restitution,
                               slot(AxisRow::upper_stop)));
      if (axis.friction > 0)
        out.push_back(touch_of(setting, state, J, none, dry_friction(axis.friction), -kInf, 0,
                               slot(AxisRow::friction)));
    }
  }
}

Law law_of_rows(const ContactLaw& law, Eigen::Index rows) {
  return rows == 1 ? unilateral() : rows == 2 ? coulomb_2d(law.mu) : coulomb(law.mu);
}

void add_gap_functions(const StepSetting& setting, const State& state, std::vector<Touch>& out) {
  const Model& model = setting.model;
  for (const GapId i : model.gaps.ids()) {
    const GapFunction& gap = model.gaps[i];
    const GapRows now = gap_function(model, state, i, state.t);
    MatX J = MatX::Zero(now.J.rows(), state.v.size());
    J.middleCols(gap.block ? first_speed(model, gap.block) : 0, now.J.cols()) = now.J;
    const VecX rate = now.rate.size() > 0 ? now.rate : VecX(VecX::Zero(J.rows()));
    out.push_back(touch_of(setting, state, J, rate, law_of_rows(gap.law, J.rows()), now.gap,
                           gap.law.restitution, slot_of(model, i)));
  }
}

std::vector<Touch> slots_at(const StepSetting& setting, const State& state) {
  std::vector<Touch> out;
  add_axes(setting, state, out);
  add_gap_functions(setting, state, out);
  return out;
}
VecX speeds_of_slots(const StepSetting& setting, const State& state) {
  std::vector<double> all;
  for (const Touch& touch : slots_at(setting, state)) all.insert(all.end(), touch.u.begin(), touch.u.end());
  return Eigen::Map<const VecX>(all.data(), Eigen::Index(all.size()));
}

// u' of a contact for constant twists (EVD-3): the gap by its Hessian, tangents by where the point of contact
// goes, drilling by where the normal goes.
VecX contact_bias(const StepSetting& setting, const State& state, const ContactPoint& c, const Mat3& frame,
                  Eigen::Index rows, bool& defined) {
  const PosedShape a = posed_shape(setting.model, state, c.a.body),
                   b = posed_shape(setting.model, state, c.b.body);
  const SE3 &g_a = pose(state, c.a.body), &g_b = pose(state, c.b.body);
  const ContactKinematics k = contact_kinematics(c, a, g_a, b, g_b);
  VecX bias = VecX::Zero(rows);
  defined = k.status == KinematicsStatus::ok;
  if (!defined) return bias;
  Vec12 xi;
  xi << twist(state, c.a.body), twist(state, c.b.body);
  const Vec3 w_a = g_a.R * xi.segment<3>(3), w_b = g_b.R * xi.segment<3>(9), n_rate = k.normal_rate * xi;
  const Vec3 past_a = w_a.cross(k.foot_a - g_a.p) + k.slide_a * xi - a.shape->radius * n_rate;
  const Vec3 past_b = w_b.cross(k.foot_b - g_b.p) + k.slide_b * xi + b.shape->radius * n_rate;
  bias[0] = xi.dot(k.gap_hessian * xi);
  if (rows == 1) return bias;
  bias.segment<2>(1) = frame.rightCols<2>().transpose() * (w_a.cross(past_a) - w_b.cross(past_b));
  if (rows > 3) bias[3] = n_rate.dot(w_a - w_b);
  return bias;
}

// What the axes of trees, which turn, add to u' of a contact while no speed changes (TREE-2).
void add_carried_rates(const Model& model, const State& state, Touch& touch) {
  const Vec3 p = mid_point(touch.point);
  const auto add = [&](BodyId body, double sign) {
    if (!is_carried(model.bodies[body])) return;
    const Vec6 rate = rate_along(model, state, [&](const State& s) {
      VecX v = s.v;
      carry_twists(model, s.g, v);
      return VecX(body_part(v, body));
    });
    const SE3& g = pose(state, body);
    const Vec3 turning = g.R * Vec3(rate.tail<3>()), moving = rate.head<3>() + turning.cross(p - g.p);
    const Eigen::Index rows = std::min<Eigen::Index>(3, touch.bias.size());
    touch.bias.head(rows) += sign * (touch.frame.transpose() * moving).head(rows);
    if (touch.bias.size() > 3) touch.bias[3] += sign * touch.frame.col(0).dot(turning);
  };
  add(touch.point.a.body, 1);
  add(touch.point.b.body, -1);
}

void add_contacts(const StepSetting& setting, const State& state, double threshold, std::vector<Touch>& out) {
  const ContactSet contacts = contacts_within(setting, state, threshold);
  const std::vector<ContactRow> rows = contact_rows(setting.model, state, setting.dofs, contacts,
                                                    VecX::Zero(state.v.size()), 1, setting.normal);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ContactRow& row = rows[i];
    if (!row.can_open) continue;
    MatX J = MatX::Zero(row.law.rows, state.v.size());
    for (int d = 0; d < row.law.rows; ++d) {
      put(J, d, row.body_a, row.J_a.row(d));
      put(J, d, row.body_b, row.J_b.row(d));
    }
    for (const Triplet& e : row.others) J(e.row(), velocity_of(setting.dofs, e.col())) += e.value();
    Touch touch = touch_of(setting, state, J, VecX::Zero(row.law.rows), row.law, contacts.points[i].gap,
                           contact_law(setting.model, row.body_a, row.body_b).restitution, {});
    touch.point = contacts.points[i];
    touch.frame = row.frame;
    touch.bias = contact_bias(setting, state, touch.point, row.frame, row.law.rows, touch.kinematics_defined);
    add_carried_rates(setting.model, state, touch);
    out.push_back(std::move(touch));
  }
}

// Of a length-like row per row: a drilling row counts its radius times.
VecX row_scale(const Law& law) {
  VecX scale = VecX::Ones(law.rows);
  if (law.kind == LawKind::contensou) scale[3] = law.radius;
  return scale;
}

// The force of a slipping touch per unit of its normal force (EVD-4), or the force itself of dry friction.
VecX slipping_force(const ClosedTouch& c) {
  const Law& law = c.touch.law;
  if (!has_gap(c.touch)) return -law.limit * c.along;
  VecX force = VecX::Zero(law.rows);
  force[0] = 1;
  force.tail(law.rows - 1) = -law.mu * c.along.cwiseProduct(row_scale(law).tail(law.rows - 1));
  return force;
}

// Rows that the solver has to find: one for what slips, whose friction follows from its normal force.
int unknowns(const ClosedTouch& c) {
  return c.friction == FrictionState::sticks ? c.touch.law.rows : 1;
}

}  // namespace

namespace {

// A problem that eliminates joints only.
FrictionProblem jointed(const SparseMatrix& M, const SparseMatrix& G, const VecX& f, const VecX& b) {
  return {.M = M, .H = SparseMatrix(M.rows(), 0), .f = f, .G = G, .b = b};
}

// Does a block push within its law, with room to spare?
bool holds(const Law& law, const VecX& r) {
  if (has_normal(law) && !(r[0] > 0)) return false;
  VecX scaled = r;
  if (law.kind == LawKind::contensou) scaled[3] /= law.radius;
  for (const Ball& ball : balls(law))
    if (!(scaled.segment(ball.first, ball.rows).norm() < (1 - kRoom) * (ball.mu * r[0] + ball.limit)))
      return false;
  return true;
}

// What pushes and sticks has no acceleration at all: one linear solution of it takes the solver's tolerance
// out of the forces, which a differential equation would see as noise. The smallest change where contacts are
// redundant.
VecX polished(const MatX& W, const VecX& q, const std::vector<Law>& laws, const VecX& r) {
  const std::vector<int> first = first_rows(laws);
  std::vector<int> held;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (holds(laws[i], r.segment(first[i], laws[i].rows)))
      for (int d = 0; d < laws[i].rows; ++d) held.push_back(first[i] + d);
    else if (!r.segment(first[i], laws[i].rows).isZero(0))
      return r;
  }
  if (held.empty()) return r;
  const auto count = Eigen::Index(held.size());
  MatX A(count, count);
  VecX rate(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    rate[i] = W.row(held[i]).dot(r) + q[held[i]];
    for (Eigen::Index j = 0; j < count; ++j) A(i, j) = W(held[i], held[j]);
  }
  Eigen::CompleteOrthogonalDecomposition<MatX> factor;
  factor.setThreshold(kRank);
  factor.compute(A);
  const VecX change = factor.solve(-rate);
  VecX out = r;
  for (Eigen::Index i = 0; i < count; ++i) out[held[i]] += change[i];
  for (std::size_t i = 0; i < laws.size(); ++i)
    if (const VecX block = out.segment(first[i], laws[i].rows); !block.isZero(0) && !holds(laws[i], block))
      return r;
  return out;
}

// Held to kAcceptedResidual instead of the solver's tolerance.
SolveReport held(SolveReport report) {
  if (report.status != SolveStatus::not_finite && report.residual <= kAcceptedResidual)
    report.status = std::min(report.status, SolveStatus::at_rounding);
  return report;
}

}  // namespace

bool has_gap(const Touch& touch) {
  return touch.law.kind != LawKind::dry_friction;
}

VecX slip_of(const Touch& touch, const VecX& u) {
  if (!has_gap(touch)) return u;
  return u.tail(touch.law.rows - 1).cwiseProduct(row_scale(touch.law).tail(touch.law.rows - 1));
}

VecX rate_along(const Model& model, const State& state, const std::function<VecX(const State&)>& f) {
  // Coordinates may be angles too
  double turning = state.q.size() > 0 ? state.v.tail(state.q.size()).lpNorm<Eigen::Infinity>() : 0;
  for (const BodyId b : model.bodies.ids()) turning = std::max(turning, twist(state, b).tail<3>().norm());
  const double d = std::min(kLargestGlide, kGlide / std::max(turning, 1e-300));
  const auto gone = [&](double time) {
    State there = retract(model, state, state.v, time);
    there.t += time;
    return there;
  };
  return (8 * (f(gone(d)) - f(gone(-d))) - (f(gone(2 * d)) - f(gone(-2 * d)))) / (12 * d);
}

std::vector<Touch> touches_at(const StepSetting& setting, const State& state, double threshold) {
  std::vector<Touch> out;
  add_contacts(setting, state, threshold, out);
  std::vector<Touch> slots = slots_at(setting, state);
  if (!slots.empty()) {
    const VecX rate =
        rate_along(setting.model, state, [&](const State& s) { return speeds_of_slots(setting, s); });
    Eigen::Index at = 0;
    for (Touch& touch : slots) {
      touch.bias = rate.segment(at, touch.u.size());
      at += touch.u.size();
    }
  }
  out.insert(out.end(), slots.begin(), slots.end());
  return out;
}

SmoothForces smooth_forces(const StepSetting& setting, const State& state) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  GeneralisedForce force = total_force(model, state, state.t);
  SmoothForces out{.axes = add_axis_forces(model, state, state.g, state.t, force)};
  carry_forces(model, state.g, force);
  out.M = mass_matrix(setting.model, state, setting.dofs);
  out.laws = free_velocities(dofs, force.f);
  clear_held(dofs, out.laws);
  for (const BlockId i : model.coordinates.ids())
    out.laws.segment(dofs.coordinates + first_coordinate(model, i), model.coordinates[i].size) +=
        block_force(model, i, state.t, coordinates(model, state, i), speeds(model, state, i)).f;
  out.applied = out.laws;
  for (const BlockId i : model.coordinates.ids())
    out.applied.segment(dofs.coordinates + first_coordinate(model, i), model.coordinates[i].size) +=
        block_weight(model, i);
  for (const BodyId b : model.bodies.ids())
    if (const int row = dofs.first[b]; row >= 0)
      out.applied.segment<3>(row) += model.bodies[b].mass * model.gravity;
  out.all = out.applied;
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const Vec3 omega = twist(state, b).tail<3>(), turning = omega.cross(model.bodies[b].inertia * omega);
    out.all.segment<3>(row + 3) -= turning;
    out.turning.angular += state.g[b].R * turning;
  }
  VecX weight = VecX::Zero(dofs.rows), gyroscopic = weight;
  for (const BlockId i : model.coordinates.ids()) {
    if (!is_tree(model.coordinates[i])) continue;
    const TreeTerms terms = tree_terms(model, i, state);
    add_tree_forces(terms, 1, dofs, weight, gyroscopic);
    out.turning += terms.turning;
  }
  out.applied += weight;
  out.all += weight + gyroscopic;
  return out;
}

namespace {

// The accelerations that forces and joints alone would give.
FrictionProblem without_touches(const StepSetting& setting, const State& state, const SmoothForces& forces) {
  const auto constraints = [&](const State& s) { return joint_constraints(setting.model, s, setting.dofs); };
  FrictionProblem out = jointed(forces.M, SparseMatrix(forces.M.rows(), 0), forces.all, VecX());
  if (setting.model.joints.empty()) return out;
  const JointConstraints now = constraints(state);
  out.G = now.G;
  if (now.off.size() == 0) return out;
  out.b = rate_along(setting.model, state, [&](const State& s) { return constraints(s).off; }) +
          2 * kStabilisation * now.off + kStabilisation * kStabilisation * now.value;  // (EVD-5)
  return out;
}

// What every touch gives and how its velocities change; `first` of its unknowns in `force`, -1: none.
void tell_touches(const std::vector<ClosedTouch>& closed, const std::vector<int>& first, const MatX& W,
                  const VecX& force, Accelerations& out) {
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const ClosedTouch& c = closed[i];
    const int count = unknowns(c);
    VecX weight = VecX::Zero(c.touch.law.rows);
    if (first[i] >= 0) weight.head(count) = W.diagonal().segment(first[i], count);
    out.weight.push_back(weight);
    if (c.friction == FrictionState::sticks)
      out.force.push_back(force.segment(first[i], count));
    else
      out.force.push_back(slipping_force(c) * (first[i] < 0 ? 1 : force[first[i]]));
    VecX rate = c.touch.N.transpose() * out.a + c.touch.bias + kStabilisation * c.touch.u;
    if (has_gap(c.touch)) rate[0] += kStabilisation * (c.touch.u[0] + kStabilisation * c.touch.gap);
    out.rate.push_back(rate);
  }
}

}  // namespace

Accelerations accelerations(const StepSetting& setting, const State& state, const SmoothForces& forces,
                            const std::vector<ClosedTouch>& closed, const std::vector<VecX>& start) {
  Accelerations out;
  FrictionProblem free = without_touches(setting, state, forces);
  // One column for what slips, all rows for what may stick.
  LocalProblem local;
  std::vector<int> first(closed.size(), -1);
  int rows = 0;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const ClosedTouch& c = closed[i];
    if (c.friction == FrictionState::slips && !has_gap(c.touch)) {
      free.f += c.touch.N * slipping_force(c);
      continue;
    }
    local.laws.push_back(c.friction == FrictionState::sticks ? c.touch.law : unilateral());
    first[i] = rows;
    rows += local.laws.back().rows;
  }
  const std::optional<MotionInverse> inverse = invert_motion(free.M, free.G);
  if (!inverse) return out;
  const VecX a_free = free_velocity(free, *inverse);
  MatX N(free.M.rows(), rows), F(free.M.rows(), rows);
  VecX bias(rows), r0 = VecX::Zero(rows);
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (first[i] < 0) continue;
    const ClosedTouch& c = closed[i];
    const int count = unknowns(c);
    N.middleCols(first[i], count) = c.touch.N.leftCols(count);
    F.middleCols(first[i], count) =
        c.friction == FrictionState::sticks ? c.touch.N : MatX(c.touch.N * slipping_force(c));
    bias.segment(first[i], count) = (c.touch.bias + kStabilisation * c.touch.u).head(count);
    if (has_gap(c.touch))
      bias[first[i]] += kStabilisation * (c.touch.u[0] + kStabilisation * c.touch.gap);  // (EVD-5)
    if (!start.empty()) r0.segment(first[i], count) = start[i].head(count);
  }
  VecX force = VecX::Zero(rows);
  MatX W(rows, rows);
  if (rows > 0) {
    const SparseMatrix F_sparse = F.sparseView();
    W = N.transpose() * MatX(*inverse * F_sparse);
    local.W = W.sparseView();
    local.q = N.transpose() * a_free + bias;
    const FrictionSolution solution = solve(local, r0, setting.options.solver);
    out.solve = held(solution.report);
    if (!is_solved(out.solve.status)) return out;
    force = polished(W, local.q, local.laws, solution.r);
  }
  free.f += F * force;
  const JointedMotion moved = motion(free, *inverse, VecX());
  out.a = moved.v;
  out.reaction = moved.lambda;
  out.solved = out.a.allFinite();
  tell_touches(closed, first, W, force, out);
  return out;
}

Collision collide(const StepSetting& setting, const State& state, const std::vector<Touch>& touches,
                  const std::vector<double>& restitution, const VecX& push) {
  const SparseMatrix M = mass_matrix(setting.model, state, setting.dofs);
  const VecX before = free_velocities(setting.dofs, state.v);
  Collision out;
  FrictionProblem problem = jointed(M, SparseMatrix(M.rows(), 0), M * before, VecX());
  if (push.size() > 0) problem.f += push;
  if (!setting.model.joints.empty()) {
    const JointConstraints now = joint_constraints(setting.model, state, setting.dofs);
    problem.G = now.G;
    problem.b = now.off - now.G.transpose() * before;
  }
  for (const Touch& touch : touches) problem.laws.push_back(touch.law);
  const std::vector<int> first = first_rows(problem.laws);
  MatX H(M.rows(), first.back());
  problem.w = VecX(first.back());
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    if (!has_gap(touch)) problem.laws[i].limit = 0;  // a bounded force has no impulse
    H.middleCols(first[i], touch.law.rows) = touch.N;
    problem.w.segment(first[i], touch.law.rows) = touch.u - touch.N.transpose() * before;
    problem.w[first[i]] += restitution[i] * std::min(touch.u[0], 0.0);  // (EVD-7)
  }
  problem.H = H.sparseView();
  const FrictionSolution solution = solve(problem, VecX(), setting.options.solver);
  out.solve = held(solution.report);
  out.solved = is_solved(out.solve.status) && solution.v.allFinite();
  out.v = solution.v;
  out.reaction = solution.lambda;
  for (std::size_t i = 0; i < touches.size(); ++i)
    out.impulse.push_back(solution.r.segment(first[i], touches[i].law.rows));
  return out;
}

}  // namespace aussois
