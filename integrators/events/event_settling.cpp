// SPDX-License-Identifier: Apache-2.0
// Impacts, then what is closed and how, at one state (EVD-6) to (EVD-9).
#include <algorithm>

#include "integrators/events/event_run.hpp"
#include "integrators/tell/ledgers.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

constexpr double kAtRest = 1e-8;         // normal speeds that count as zero: what tolerances leave [m/s]
constexpr double kAcceleration = 1e-10;  // accelerations that count as zero, of the largest around [-]
constexpr double kLiftOff = 1e-13;       // gaps of what opens without speed are known to this [m]
constexpr double kPush = 1e-9;           // forces act so long to show which jump they cause (EVD-8) [s]

double kinetic(const StepSetting& setting, const State& state) {
  return energy(setting.model, state).kinetic;
}

// Of an impulse on the relative velocity, mean of before and after.
double work_on(const Touch& touch, const VecX& change, const VecX& r) {
  return r.dot(touch.u + touch.N.transpose() * change / 2);
}

/// What opens from an overlap has come back when it is deeper than that.
double overlap_of(const Touch& touch) {
  return std::max(0.0, -touch.gap);
}

}  // namespace

void EventRun::add_event(EventKind kind, const Touch& touch, double t, double speed) {
  const bool contact = !touch.slot;
  report_.events.push_back({.kind = kind,
                            .t = t,
                            .body_a = contact ? touch.point.a.body : BodyId(),
                            .body_b = contact ? touch.point.b.body : BodyId(),
                            .slot = touch.slot,
                            .speed = speed});
}

void EventRun::add_impulse(const Touch& touch, const VecX& r, double work) {
  if (touch.slot) {
    state_.r.segment(*touch.slot, r.size()) += r;
    if (of_a_joint(touch)) return;
    const auto id = gap_of(model_, touch.slot);
    const auto known = std::ranges::find(report_.gaps, id, &StepGap::id);
    StepGap& gap =
        known == report_.gaps.end() ? report_.gaps.emplace_back(StepGap{.id = id, .gap = touch.gap}) : *known;
    gap.impulse.head(r.size()) += r;
    gap.work += work;
    return;
  }
  const auto known = std::ranges::find_if(
      report_.contacts, [&](const StepContact& c) { return key_of(c.point) == key_of(touch.point); });
  StepContact& contact = known == report_.contacts.end()
                             ? report_.contacts.emplace_back(StepContact{.point = touch.point})
                             : *known;
  const Eigen::Index of_frame = std::min<Eigen::Index>(3, r.size());  // one row without friction
  contact.impulse += touch.frame.leftCols(of_frame) * r.head(of_frame);
  if (r.size() > 3) contact.drilling += r[3];
  contact.work += work;
}

// (EVD-7), and (EVD-9) for what would leave too slowly.
bool EventRun::collisions(std::vector<Touch>& touches) {
  std::vector<Touch> near;
  std::vector<double> restitution;
  bool any = false;
  for (const Touch& touch : touches) {
    if (touch.gap > o_.gap_tolerance) continue;
    const double closing = has_gap(touch) ? std::max(0.0, -touch.u[0]) : 0;
    restitution.push_back(touch.restitution * closing >= o_.rest_speed ? touch.restitution : 0);
    near.push_back(touch);
    any = any || closing > kAtRest;
  }
  if (!any) return true;
  const VecX before = free_velocities(setting_.dofs, state_.v);
  const Collision hit = collide(setting_, state_, near, restitution);
  count_solve(hit.solve);
  if (!hit.solved) return refused("the impact was not solved");
  state_.v = all_velocities(setting_.dofs, hit.v, state_.v);
  carry_twists(model_, state_.g, state_.v);
  add_jump(near, hit, before);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double closing = has_gap(near[i]) ? -near[i].u[0] : 0;
    if (closing <= kAtRest) continue;
    const bool ends = near[i].restitution > 0 && restitution[i] == 0;
    add_event(ends ? EventKind::rest : EventKind::impact, near[i], state_.t, closing);
  }
  touches = touches_at(setting_, state_, o_.horizon);
  return true;
}

// (EVD-8): what a short push makes jump.
bool EventRun::jump_without_collision(const std::vector<Touch>& touches) {
  std::vector<Touch> near;
  for (const Touch& touch : touches)
    if (touch.gap <= o_.gap_tolerance) near.push_back(touch);
  const VecX push = kPush * smooth_forces(setting_, state_).all,
             before = free_velocities(setting_.dofs, state_.v);
  const Collision hit = collide(setting_, state_, near, std::vector<double>(near.size(), 0), push);
  count_solve(hit.solve);
  const double jump = hit.solved ? (hit.v - before).cwiseAbs().maxCoeff() : 0;
  if (!hit.solved || jump < o_.stick_speed + 100 * push.cwiseAbs().maxCoeff())
    return refused("no finite forces keep the closed contacts closed, and no impulse opens them (Painleve)");
  state_.v = all_velocities(setting_.dofs, hit.v, state_.v);
  carry_twists(model_, state_.g, state_.v);
  add_jump(near, hit, before);
  for (std::size_t i = 0; i < near.size(); ++i)
    if (hit.impulse[i].norm() > 0) add_event(EventKind::tangential_impact, near[i], state_.t);
  momentum_.forces += momentum_given(setting_, state_, push);
  work_[by_laws] += push.dot(before + hit.v) / 2;
  return true;
}

// What all impulses of a jump from `before` gave, at the present poses.
void EventRun::add_jump(const std::vector<Touch>& near, const Collision& hit, const VecX& before) {
  const VecX middle = (before + hit.v) / 2;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const bool joint = of_a_joint(near[i]);
    const VecX impulse = near[i].N * hit.impulse[i];
    work_[joint ? by_joints : by_contacts] += middle.dot(impulse);
    (joint ? momentum_.joints : momentum_.contacts) += momentum_given(setting_, state_, impulse);
    add_impulse(near[i], hit.impulse[i], work_on(near[i], hit.v - before, hit.impulse[i]));
    if (joint) add_touch(near[i], hit.impulse[i][0], before, middle, joints_);
  }
  if (joints_.empty()) return;
  const JointConstraints held = joint_constraints(model_, state_, setting_.dofs);
  const VecX impulse = held.G * hit.reaction;
  work_[by_joints] += middle.dot(impulse);
  momentum_.joints += momentum_given(setting_, state_, impulse);
  add_forces(model_, held.columns, hit.reaction, state_.g, 1, joints_);
  add_column_work(model_, held.columns, hit.reaction, worked_on(state_, middle), joints_);
}

WorkVelocities EventRun::worked_on(const State& state, const VecX& v) const {
  return {all_velocities(setting_.dofs, v, state.v),
          all_velocities(setting_.dofs, VecX::Zero(v.size()), state.v)};
}

// Joints back to where they hold (EVD-5), also when the velocity of a moved body jumps.
void EventRun::project() {
  const Momentum before = momentum(model_, state_);
  const double kinetic_before = kinetic(setting_, state_);
  const VecX v = state_.v;
  ProjectedState held = projected_state(model_, state_);
  state_ = std::move(held.state);
  momentum_.joints += momentum(model_, state_) - before;
  work_[by_joints] += kinetic(setting_, state_) - kinetic_before;
  add_forces(model_, held.columns, held.lambda, state_.g, 1, joints_);
  add_column_work(model_, held.columns, held.lambda,
                  worked_on(state_, free_velocities(setting_.dofs, (v + state_.v) / 2)), joints_);
}

// The impacts that were left out would have ended after a geometric series of flights (EVD-9).
void EventRun::foretell_rest(const Accelerations& now) {
  for (StepEvent& event : report_.events) {
    if (event.kind != EventKind::rest || event.t != state_.t) continue;
    for (std::size_t i = 0; i < closed_.size(); ++i) {
      const Touch& touch = closed_[i].touch;
      const bool meant = event.slot ? touch.slot == event.slot
                                    : !touch.slot && touch.point.a.body == event.body_a &&
                                          touch.point.b.body == event.body_b;
      const double pressed = now.weight[i][0] * now.force[i][0];  // the acceleration that closes it
      if (!meant || !(pressed > tolerance_) || touch.restitution == 1) continue;
      event.t += 2 * touch.restitution * event.speed / (pressed * (1 - touch.restitution));
      break;
    }
  }
}

// Which touches stay closed, which of them stick, from the accelerations (EVD-6).
bool EventRun::decide(const std::vector<Touch>& touches) {
  closed_.clear();
  leaving_.clear();
  for (const Touch& touch : touches) {
    if (touch.gap > o_.gap_tolerance) continue;
    if (has_gap(touch) && touch.u[0] > o_.rest_speed) {
      leaving_.push_back({touch, overlap_of(touch)});
      continue;
    }
    if (!touch.kinematics_defined)
      return refused("a closed contact between parallel edges has no acceleration");
    ClosedTouch c{.touch = touch};
    const VecX slip = slip_of(touch, touch.u);
    c.along = VecX::Zero(slip.size());
    if (slip.size() > 0 && (touch.law.mu > 0 || !has_gap(touch)))
      c.friction = slip.norm() <= o_.stick_speed ? FrictionState::sticks : FrictionState::slips;
    if (c.friction == FrictionState::slips) c.along = slip.normalized();
    closed_.push_back(std::move(c));
  }
  const SmoothForces forces = smooth_forces(setting_, state_);
  const auto accelerate = [&] {
    Accelerations out = accelerations(setting_, state_, forces, closed_, {});
    if (out.solved)
      count_solve(out.solve);
    else
      add_counts(out.solve, report_.solve);
    return out;
  };
  Accelerations now = accelerate();
  if (!now.solved) return false;
  tolerance_ = kAcceleration * std::max(1.0, now.a.size() > 0 ? now.a.cwiseAbs().maxCoeff() : 0) +
               kAcceleration * model_.gravity.norm();
  bool again = false;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    ClosedTouch& c = closed_[i];
    if (c.friction != FrictionState::sticks) continue;
    const VecX slip = slip_of(c.touch, now.rate[i]);
    if (slip.norm() <= tolerance_ / 2 || (has_gap(c.touch) && now.force[i][0] <= 0)) continue;
    c.friction = FrictionState::slips;
    c.along = slip.normalized();
    again = true;
  }
  if (again && !(now = accelerate()).solved) return false;
  foretell_rest(now);
  a_ = all_velocities(setting_.dofs, now.a, VecX::Zero(state_.v.size()));
  std::vector<ClosedTouch> stay;
  force_.clear();
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (has_gap(closed_[i].touch) && now.force[i][0] <= 0 && now.rate[i][0] > tolerance_ / 2) {
      leaving_.push_back({closed_[i].touch, kLiftOff + overlap_of(closed_[i].touch)});
      continue;
    }
    stay.push_back(closed_[i]);
    force_.push_back(now.force[i]);
  }
  closed_ = std::move(stay);
  return true;
}

// Events of what was closed before.
void EventRun::compare(const std::vector<ClosedTouch>& before) {
  const std::vector<int> match = matched(touches_of(before), touches_of(closed_));
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (match[i] < 0) {
      add_event(EventKind::release, before[i].touch, state_.t);
      continue;
    }
    const ClosedTouch& now = closed_[match[i]];
    if (before[i].friction == FrictionState::sticks && now.friction == FrictionState::slips)
      add_event(EventKind::slip, now.touch, state_.t);
    if (before[i].friction != FrictionState::slips) continue;
    if (now.friction == FrictionState::sticks) add_event(EventKind::stick, now.touch, state_.t);
    if (now.friction == FrictionState::slips && now.along.dot(before[i].along) < -0.5 &&
        slip_of(now.touch, now.touch.u).norm() <= o_.stick_speed)
      add_event(EventKind::reversal, now.touch, state_.t);
  }
}

// Impacts, then what is closed and how, at the present state.
bool EventRun::settle(bool first) {
  move_prescribed();
  if (!model_.joints.empty()) project();
  const std::vector<ClosedTouch> before = std::move(closed_);
  std::vector<Touch> touches = touches_at(setting_, state_, o_.horizon);
  if (!collisions(touches)) return false;
  if (!decide(touches)) {
    if (report_.status != StepStatus::ok || !jump_without_collision(touches)) return false;
    if (!decide(touches_at(setting_, state_, o_.horizon)))
      return refused("the accelerations were not solved");
  }
  if (!first) compare(before);
  return true;
}

}  // namespace aussois
