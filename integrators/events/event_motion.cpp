// SPDX-License-Identifier: Apache-2.0
// The differential equation between events, and where it ends (EVD-2) to (EVD-6).
#include <algorithm>
#include <cmath>

#include "integrators/events/event_run.hpp"
#include "integrators/tell/ledgers.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

constexpr double kDirection = 1e-8;  // slips slower than this keep the direction they began with [m/s]
constexpr double kSurelyOff = 1e-9;  // until then a contact that just opened is not checked [s]

JointSums sums_of(const StepJoint& joint) {
  const JointWork& w = joint.work;
  JointSums out;
  out << joint.force, joint.torque, joint.effort, w.locked, w.couplings, w.stops, w.friction, w.motors,
      w.springs, w.supports;
  return out;
}
void add_sums(const JointSums& sums, StepJoint& joint) {
  joint.force += sums.head<3>();
  joint.torque += sums.segment<3>(3);
  joint.effort += sums.segment<3>(6);
  JointWork& w = joint.work;
  int k = 9;
  for (double* part : {&w.locked, &w.couplings, &w.stops, &w.friction, &w.motors, &w.springs, &w.supports})
    *part += sums[k++];
}

bool same(const Touch& a, const Touch& b) {
  return a.slot == b.slot && (a.slot || key_of(a.point) == key_of(b.point));
}

}  // namespace

std::vector<int> matched(const std::vector<Touch>& old, const std::vector<Touch>& now) {
  std::vector<int> out(old.size(), -1);
  std::vector<char> taken(now.size(), 0);
  const auto take = [&](std::size_t i, std::size_t j) { out[i] = int(j), taken[j] = 1; };
  for (std::size_t i = 0; i < old.size(); ++i)
    for (std::size_t j = 0; j < now.size() && out[i] < 0; ++j)
      if (!taken[j] && same(old[i], now[j])) take(i, j);
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (out[i] >= 0 || old[i].slot) continue;
    double least = kInf;
    std::size_t best = 0;
    for (std::size_t j = 0; j < now.size(); ++j) {
      const ContactPoint &a = old[i].point, &b = now[j].point;
      if (taken[j] || now[j].slot || a.a.body != b.a.body || a.b.body != b.b.body) continue;
      const double distance = (a.x_a - b.x_a).norm();
      if (distance < least) least = distance, best = j;
    }
    if (least < kInf) take(i, best);
  }
  return out;
}

std::vector<Touch> touches_of(const std::vector<ClosedTouch>& closed) {
  std::vector<Touch> out;
  for (const ClosedTouch& c : closed) out.push_back(c.touch);
  return out;
}

EventLayout layout_of(const StepSetting& setting, const std::vector<ClosedTouch>& closed) {
  EventLayout out;
  const auto moves = [](int row) { return row >= 0; };
  out.q = 7 * int(std::ranges::count_if(setting.dofs.first, moves));
  out.v = out.q + (setting.dofs.rows - setting.dofs.coordinates);
  out.work = out.v + setting.dofs.rows;
  out.impulse = out.work + kWorks;
  out.touch_work = out.impulse;
  for (const ClosedTouch& c : closed) {
    out.first_impulse.push_back(out.touch_work);
    out.touch_work += c.touch.law.rows;
  }
  out.momentum = out.touch_work + int(closed.size());
  out.joints = out.momentum + kMomentum * kMomenta;
  out.size = out.joints + kJointSums * int(setting.model.joints.size());
  return out;
}

void add_touch(const Touch& touch, double p, const VecX& v, const VecX& on,
               Table<JointId, StepJoint>& joints) {
  const double moved = touch.u[0] - touch.N.col(0).dot(v);
  add_effort(axis_slot(*touch.slot), p, 1, joints);
  add_axis_work(axis_slot(*touch.slot), p, moved + touch.N.col(0).dot(on), moved, joints);
}

VecX EventRun::packed() const {
  VecX y = VecX::Zero(layout_.size);
  int at = 0;
  for (const BodyId b : model_.bodies.ids()) {
    if (setting_.dofs.first[b] < 0) continue;
    y.segment<3>(at) = state_.g[b].p;
    y.segment<4>(at + 3) = state_.g[b].R.coeffs();
    at += 7;
  }
  y.segment(layout_.q, state_.q.size()) = state_.q;
  y.segment(layout_.v, setting_.dofs.rows) = free_velocities(setting_.dofs, state_.v);
  return y;
}

State EventRun::unpacked(double t, const VecX& y) const {
  State out = state_;
  out.t = t;
  int at = 0;
  for (const BodyId b : model_.bodies.ids()) {
    if (setting_.dofs.first[b] >= 0) {
      pose(out, b).p = y.segment<3>(at);
      pose(out, b).R = Quat(Eigen::Vector4d(y.segment<4>(at + 3))).normalized();
      at += 7;
    } else {
      pose(out, b) = retract(pose(state_, b), twist(state_, b), t - state_.t);
    }
  }
  out.q = y.segment(layout_.q, state_.q.size());
  out.v = all_velocities(setting_.dofs, y.segment(layout_.v, setting_.dofs.rows), state_.v);
  carry_poses(model_, out.q, out.g);
  carry_twists(model_, out.g, out.v);
  if (!model_.joints.empty()) out.turns = counted_turns(model_, turned_, out.g);
  return out;
}

// The closed touches where they are now, their slip in the direction that continues the one they began with
// through zero, so that the rate is smooth there.
std::vector<ClosedTouch> EventRun::closed_at(const std::vector<Touch>& touches,
                                             std::vector<int>& match) const {
  match = matched(touches_of(closed_), touches);
  std::vector<ClosedTouch> out;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (match[i] < 0) continue;
    ClosedTouch c = closed_[i];
    c.touch = touches[match[i]];
    if (c.friction == FrictionState::slips) {
      const VecX slip = slip_of(c.touch, c.touch.u);
      const double sign = slip.dot(closed_[i].along) < 0 ? -1 : 1;
      const double keeps = kDirection / (1 + slip.squaredNorm() / (kDirection * kDirection));
      c.along = (sign * slip + keeps * closed_[i].along).normalized();
    }
    out.push_back(std::move(c));
  }
  return out;
}

namespace {

// Rates of momenta, part by part (EVD-11).
class MomentumRates {
 public:
  MomentumRates(const StepSetting& setting, const State& state, const SparseMatrix& mass, int first,
                VecX& out)
      : setting_(setting), state_(state), first_(first), out_(out) {
    if (carries_bodies(setting.model)) inverse_ = invert_mass(mass);
  }
  void add(EventMomentum part, const VecX& force) const {
    add(part, inverse_ ? momentum_given(setting_, state_, force, inverse_)
                       : momentum_given(setting_, state_, force));
  }
  // What speeds alone change, `gyroscopic` forces among it: the bases of trees take it (TREE-7).
  void add_turning(const VecX& gyroscopic, const Momentum& turning) const {
    if (!inverse_) return;
    add(of_joints, gyroscopic);
    add(of_joints, turning);
  }

 private:
  void add(EventMomentum part, const Momentum& rate) const {
    out_.segment<3>(first_ + kMomentum * part) += rate.linear;
    out_.segment<3>(first_ + kMomentum * part + 3) += rate.angular;
  }

  const StepSetting& setting_;
  const State& state_;
  int first_;
  VecX& out_;
  std::optional<MassInverse> inverse_{};
};

// What masses that depend on their coordinates give while no speed changes. In trees, gyroscopic forces
// cancel it.
double power_of_masses(const Model& model, const State& state) {
  const auto depends = [](const Coordinates& block) { return !is_tree(block) && block.points.empty(); };
  if (std::ranges::none_of(model.coordinates, depends)) return 0;
  return rate_along(model, state, [&](const State& moved) -> VecX {
    double energy = 0;
    for (const BlockId i : model.coordinates.ids()) {
      if (!depends(model.coordinates[i])) continue;
      const VecX v = speeds(model, moved, i);
      energy += 0.5 * v.dot(block_mass(model, i, coordinates(model, moved, i)) * v);
    }
    return VecX::Constant(1, energy);
  })[0];
}

}  // namespace

bool EventRun::rate(double t, const VecX& y, VecX& out) const {
  const State s = unpacked(t, y);
  std::vector<int> match;
  const std::vector<ClosedTouch> closed = closed_at(touches_at(setting_, s, o_.horizon), match);
  const SmoothForces forces = smooth_forces(setting_, s);
  const Accelerations now = accelerations(setting_, s, forces, closed,
                                          closed.size() == force_.size() ? force_ : std::vector<VecX>{});
  if (!now.solved) return false;
  out.setZero();
  int at = 0;
  for (const BodyId b : model_.bodies.ids()) {
    if (setting_.dofs.first[b] < 0) continue;
    const Vec6 v = twist(s, b);
    const Quat R(Eigen::Vector4d(y.segment<4>(at + 3)));
    out.segment<3>(at) = v.head<3>();
    out.segment<4>(at + 3) = (R * Quat(0, v[3] / 2, v[4] / 2, v[5] / 2)).coeffs();
    at += 7;
  }
  const VecX v = y.segment(layout_.v, setting_.dofs.rows);
  out.segment(layout_.q, s.q.size()) = v.tail(s.q.size());
  out.segment(layout_.v, v.size()) = now.a;
  out[layout_.work + by_laws] = forces.laws.dot(v);
  const MomentumRates momenta(setting_, s, forces.M, layout_.momentum, out);
  momenta.add(of_forces, forces.applied);
  momenta.add_turning(forces.all - forces.applied, forces.turning);
  Table<JointId, StepJoint> joints(model_.joints.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (match[i] < 0) continue;
    const Touch& touch = closed[k].touch;
    const VecX force = touch.N * now.force[k];
    out[layout_.work + (of_a_joint(touch) ? by_joints : by_contacts)] += v.dot(force);
    momenta.add(of_a_joint(touch) ? of_joints : of_contacts, force);
    if (of_a_joint(touch)) add_touch(touch, now.force[k][0], v, v, joints);
    out.segment(layout_.first_impulse[i], touch.law.rows) = now.force[k];
    out[layout_.touch_work + Eigen::Index(i)] = touch.u.dot(now.force[k]);
    ++k;
  }
  if (!joints.empty()) {
    const JointConstraints held = joint_constraints(model_, s, setting_.dofs);
    const VecX force = held.G * now.reaction;
    out[layout_.work + by_joints] += v.dot(force);
    momenta.add(of_joints, force);
    const WorkVelocities on = worked_on(s, v);
    add_forces(model_, held.columns, now.reaction, s.g, 1, joints);
    add_column_work(model_, held.columns, now.reaction, on, joints);
    add_spring_and_motor_work(model_, forces.axes, 0 * s.v, on, joints);
    for (const JointId j : joints.ids())
      out.segment<kJointSums>(layout_.joints + kJointSums * j.index()) = sums_of(joints[j]);
  }
  out[layout_.work + by_mass] = power_of_masses(model_, s);
  return true;
}

// (EVD-6): all that fall through zero where the piece ends.
bool EventRun::roots(double t, const VecX& y, VecX& out) const {
  const State s = unpacked(t, y);
  const std::vector<Touch> touches = touches_at(setting_, s, o_.horizon);
  std::vector<int> match;
  const std::vector<ClosedTouch> closed = closed_at(touches, match);
  std::vector<char> open(touches.size(), 1);
  for (const int m : match)
    if (m >= 0) open[m] = 0;
  std::vector<Touch> left;
  for (const LeavingTouch& l : leaving_) left.push_back(l.touch);
  std::vector<double> offset(touches.size(), -1);
  const std::vector<int> leaving = matched(left, touches);
  for (std::size_t i = 0; i < leaving.size(); ++i)
    if (leaving[i] >= 0) offset[leaving[i]] = leaving_[i].offset;

  out.setOnes();
  out[0] = o_.horizon;
  const double gone = t - state_.t;
  for (std::size_t j = 0; j < touches.size(); ++j) {
    if (!open[j] || !has_gap(touches[j])) continue;
    double f = touches[j].gap;
    if (offset[j] >= 0 && std::abs(touches[j].gap) < o_.horizon)  // the mean speed that it left with
      f = gone < kSurelyOff ? 1 : (touches[j].gap + offset[j]) / gone;
    out[0] = std::min(out[0], f);
  }
  if (closed_.empty()) return true;
  const Accelerations now = accelerations(setting_, s, smooth_forces(setting_, s), closed,
                                          closed.size() == force_.size() ? force_ : std::vector<VecX>{});
  if (!now.solved) return false;
  std::size_t k = 0;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    double &release = out[Eigen::Index(1 + 2 * i)], &friction = out[Eigen::Index(2 + 2 * i)];
    if (match[i] < 0) {
      release = -1;
      continue;
    }
    const ClosedTouch& c = closed[k];
    const VecX &force = now.force[k], &rate = now.rate[k], &weight = now.weight[k];
    ++k;
    if (has_gap(c.touch)) release = std::abs(weight[0]) * force[0] - rate[0] + tolerance_;
    if (c.friction == FrictionState::slips) friction = slip_of(c.touch, c.touch.u).dot(closed_[i].along);
    if (c.friction == FrictionState::sticks) {
      const double grip = has_gap(c.touch) ? c.touch.law.mu * force[0] : c.touch.law.limit;
      VecX held = has_gap(c.touch) ? VecX(force.tail(force.size() - 1)) : force;
      if (c.touch.law.kind == LawKind::contensou) held[2] /= c.touch.law.radius;
      const double mean = weight.tail(held.size()).mean();
      friction = mean * (grip - held.norm()) - slip_of(c.touch, rate).norm() + tolerance_;
    }
  }
  return true;
}

// Quadratures of the piece, once it is accepted.
void EventRun::take(const VecX& y) {
  for (int k = 0; k < kWorks; ++k) work_[k] += y[layout_.work + k];
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    add_impulse(closed_[i].touch, y.segment(layout_.first_impulse[i], closed_[i].touch.law.rows),
                y[layout_.touch_work + Eigen::Index(i)]);
  }
  for (const JointId j : joints_.ids())
    add_sums(y.segment<kJointSums>(layout_.joints + kJointSums * j.index()), joints_[j]);
  const auto part = [&](EventMomentum k) {
    return Momentum{y.segment<3>(layout_.momentum + kMomentum * k),
                    y.segment<3>(layout_.momentum + kMomentum * k + 3)};
  };
  momentum_.forces += part(of_forces);
  momentum_.contacts += part(of_contacts);
  momentum_.joints += part(of_joints);
}

}  // namespace aussois
