// SPDX-License-Identifier: Apache-2.0
#include "integrators/event_driven.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "geometry/check.hpp"
#include "integrators/attempt.hpp"
#include "integrators/touching.hpp"
#include "lmd/motion_bound.hpp"

namespace aussois {
namespace {

constexpr double kAtRest = 1e-8;         // normal speeds that count as zero: what tolerances leave [m/s]
constexpr double kAcceleration = 1e-10;  // accelerations that count as zero, of the largest around [-]
constexpr double kDirection = 1e-10;     // slips slower than this keep the direction they began with [m/s]
constexpr double kSurelyOff = 1e-9;  // until then a contact that just opened is not asked whether it did [s]
constexpr double kLiftOff = 1e-13;   // gaps of what opens without speed are known to this [m]
constexpr double kPush = 1e-9;       // forces act so long to see which jump they ask for (EVD-8) [s]
constexpr double kChord = 1e-3;      // pieces of the certificate follow the path to this part of a dilation
constexpr double kTiny = 1e-12;      // instead of zero [m/s^2]
constexpr double kSameTime = 1e-12;  // rows of paths nearer than this are there: sums of steps round [s]
constexpr int kMaxPieces = 256, kMaxRetries = 20;

bool same(const Touch& a, const Touch& b) {
  return a.slot == b.slot && (a.slot >= 0 || key_of(a.point) == key_of(b.point));
}

// The touch of a list that goes on with `old`: the same features, or the nearest contact of the same bodies
// that goes on with none of the others; -1: none.
std::vector<int> matched(const std::vector<Touch>& old, const std::vector<Touch>& now) {
  std::vector<int> out(old.size(), -1);
  std::vector<char> taken(now.size(), 0);
  const auto take = [&](std::size_t i, std::size_t j) { out[i] = int(j), taken[j] = 1; };
  for (std::size_t i = 0; i < old.size(); ++i)
    for (std::size_t j = 0; j < now.size() && out[i] < 0; ++j)
      if (!taken[j] && same(old[i], now[j])) take(i, j);
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (out[i] >= 0 || old[i].slot >= 0) continue;
    double least = kInf;
    std::size_t best = 0;
    for (std::size_t j = 0; j < now.size(); ++j) {
      const ContactPoint &a = old[i].point, &b = now[j].point;
      if (taken[j] || now[j].slot >= 0 || a.a.body != b.a.body || a.b.body != b.b.body) continue;
      const double distance = (a.x_a - b.x_a).norm();
      if (distance < least) least = distance, best = j;
    }
    if (least < kInf) take(i, best);
  }
  return out;
}

std::vector<Touch> touches_of(const std::vector<Closed>& closed) {
  std::vector<Touch> out;
  for (const Closed& c : closed) out.push_back(c.touch);
  return out;
}

// A touch that opened at the start of the piece; `offset` as far as its gap is known.
struct Leaving {
  Touch touch{};
  double offset = 0;  // [m]
};

// Where the parts of the differential equation stand in its vector (EVD-2).
struct Layout {
  int bodies = 0, q = 0, v = 0, work = 0, impulse = 0, reaction = 0, size = 0;
  std::vector<int> first_impulse{};  // of every closed touch
};
enum Work { by_laws, by_contacts, by_joints, by_mass, kWorks };

Layout layout_of(const StepSetting& setting, const std::vector<Closed>& closed, int constraints) {
  Layout out;
  out.q = 7 * (setting.dofs.coordinates / 6);
  out.v = out.q + (setting.dofs.rows - setting.dofs.coordinates);
  out.work = out.v + setting.dofs.rows;
  out.impulse = out.work + kWorks;
  out.reaction = out.impulse;
  for (const Closed& c : closed) {
    out.first_impulse.push_back(out.reaction);
    out.reaction += c.touch.law.rows;
  }
  out.size = out.reaction + constraints;
  return out;
}

double kinetic(const StepSetting& setting, const State& state) {
  return energy(setting.model, state).kinetic;
}

/// One step: from event to event.
class Run {
 public:
  Run(const StepSetting& setting, const EventDrivenOptions& options, const State& start, double h)
      : setting_(setting), o_(options), model_(setting.model), state_(start), t_end_(start.t + h) {
    state_.r = row_count(model_) > 0 ? VecX(VecX::Zero(row_count(model_))) : VecX();
    reaction_ = VecX::Zero(joint_constraints(model_, start, setting.dofs).off.size());
  }

  StepReport go(State& out);

 private:
  bool settle(bool first);
  bool collisions(std::vector<Touch>& touches);
  bool jump_without_collision(const std::vector<Touch>& touches);
  bool decide(const std::vector<Touch>& touches);
  void foretell_rest(const Accelerations& now);
  void compare(const std::vector<Closed>& before);
  bool piece();
  double safe_until(const State& from, double stop) const;
  bool leapt(const State& from, const State& to) const;
  bool certified(const State& from, const State& to, const std::function<State(double)>& at);

  VecX packed() const;
  State unpacked(double t, const VecX& y) const;
  std::vector<Closed> closed_at(const std::vector<Touch>& touches, std::vector<int>& match) const;
  bool rate(double t, const VecX& y, VecX& out) const;
  bool roots(double t, const VecX& y, VecX& out) const;
  void take(const VecX& y);
  double next_row() const;
  void move_prescribed();
  void add_event(EventKind kind, const Touch& touch, double t, double speed = 0);
  void add_impulse(const Touch& touch, const VecX& r);
  bool refused(const std::string& reason) {
    report_.status = StepStatus::refused;
    report_.reason = reason;
    return false;
  }

  const StepSetting& setting_;
  const EventDrivenOptions& o_;
  const Model& model_;
  State state_;  // where the run is
  double t_end_;
  StepReport report_{};
  VecX reaction_{};  // impulses of the joints so far
  double work_[kWorks] = {};
  int stops_ = 0;

  // Of the piece that begins at state_
  std::vector<Closed> closed_{};
  std::vector<Leaving> leaving_{};
  std::vector<VecX> force_{};  // at its start
  VecX a_{};                   // likewise, in the places of State::v
  double tolerance_ = 0;       // accelerations below count as zero [m/s^2]
  Layout layout_{};
  State turned_{};  // the state that turns are counted from
};

void Run::add_event(EventKind kind, const Touch& touch, double t, double speed) {
  const bool contact = touch.slot < 0;
  report_.events.push_back({.kind = kind,
                            .t = t,
                            .body_a = contact ? touch.point.a.body : -1,
                            .body_b = contact ? touch.point.b.body : -1,
                            .slot = touch.slot,
                            .speed = speed});
}

void Run::add_impulse(const Touch& touch, const VecX& r) {
  if (touch.slot >= 0) {
    state_.r.segment(touch.slot, r.size()) += r;
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
}

// Prescribed bodies stand and move where their paths say.
void Run::move_prescribed() {
  for (int b = 0; b < int(model_.bodies.size()); ++b)
    if (const auto* motion = std::get_if<Prescribed>(&model_.bodies[std::size_t(b)].motion)) {
      const TrajectoryPoint now = evaluate(motion->path, state_.t + kSameTime);
      pose(state_, b) = now.pose;
      twist(state_, b) = now.twist;
    }
}

// The next time at which a prescribed velocity jumps.
double Run::next_row() const {
  double next = t_end_;
  for (const RigidBody& body : model_.bodies)
    if (const auto* motion = std::get_if<Prescribed>(&body.motion))
      if (const auto row = std::ranges::upper_bound(motion->path.t, state_.t + kSameTime);
          row != motion->path.t.end() && *row < t_end_ - kSameTime)
        next = std::min(next, *row);
  return next;
}

// (EVD-7), and (EVD-9) for what would leave too slowly.
bool Run::collisions(std::vector<Touch>& touches) {
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
  if (!hit.solved) return refused("the impact was not solved");
  const VecX middle = (before + hit.v) / 2;
  const double kinetic_before = kinetic(setting_, state_);
  state_.v = all_velocities(setting_.dofs, hit.v, state_.v);
  double by_contact = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double work = middle.dot(near[i].N * hit.impulse[i]);
    if (near[i].slot < 0 || near[i].slot >= first_gap_row(model_)) by_contact += work;
    add_impulse(near[i], hit.impulse[i]);
    const double closing = has_gap(near[i]) ? -near[i].u[0] : 0;
    if (closing <= kAtRest) continue;
    const bool ends = near[i].restitution > 0 && restitution[i] == 0;
    add_event(ends ? EventKind::rest : EventKind::impact, near[i], state_.t, closing);
  }
  work_[by_contacts] += by_contact;
  work_[by_joints] += kinetic(setting_, state_) - kinetic_before - by_contact;
  if (reaction_.size() > 0) reaction_ += hit.reaction;
  touches = touches_at(setting_, state_, o_.horizon);
  return true;
}

// (EVD-8): what a short push makes jump.
bool Run::jump_without_collision(const std::vector<Touch>& touches) {
  std::vector<Touch> near;
  for (const Touch& touch : touches)
    if (touch.gap <= o_.gap_tolerance) near.push_back(touch);
  const VecX push = kPush * smooth_forces(setting_, state_).all,
             before = free_velocities(setting_.dofs, state_.v);
  const Collision hit = collide(setting_, state_, near, std::vector<double>(near.size(), 0), push);
  const double jump = hit.solved ? (hit.v - before).cwiseAbs().maxCoeff() : 0;
  if (!hit.solved || jump < o_.stick_speed + 100 * push.cwiseAbs().maxCoeff())
    return refused("no finite forces keep the closed contacts closed, and no impulse opens them (Painleve)");
  const VecX middle = (before + hit.v) / 2;
  state_.v = all_velocities(setting_.dofs, hit.v, state_.v);
  for (std::size_t i = 0; i < near.size(); ++i) {
    work_[by_contacts] += middle.dot(near[i].N * hit.impulse[i]);
    add_impulse(near[i], hit.impulse[i]);
    if (hit.impulse[i].norm() > 0) add_event(EventKind::tangential_impact, near[i], state_.t);
  }
  if (reaction_.size() > 0) reaction_ += hit.reaction;
  return true;
}

// The impacts that were left out would have ended after a geometric series of flights (EVD-9).
void Run::foretell_rest(const Accelerations& now) {
  for (StepEvent& event : report_.events) {
    if (event.kind != EventKind::rest || event.t != state_.t) continue;
    for (std::size_t i = 0; i < closed_.size(); ++i) {
      const Touch& touch = closed_[i].touch;
      const bool meant = event.slot >= 0 ? touch.slot == event.slot
                                         : touch.slot < 0 && touch.point.a.body == event.body_a &&
                                               touch.point.b.body == event.body_b;
      const double pressed = now.weight[i][0] * now.force[i][0];  // the acceleration that closes it
      if (!meant || !(pressed > tolerance_) || touch.restitution == 1) continue;
      event.t += 2 * touch.restitution * event.speed / (pressed * (1 - touch.restitution));
      break;
    }
  }
}

// Which touches stay closed, which of them stick, from the accelerations (EVD-6).
bool Run::decide(const std::vector<Touch>& touches) {
  closed_.clear();
  leaving_.clear();
  for (const Touch& touch : touches) {
    if (touch.gap > o_.gap_tolerance) continue;
    if (has_gap(touch) && touch.u[0] > o_.rest_speed) {
      leaving_.push_back({touch, 0});
      continue;
    }
    if (!touch.kinematics_defined)
      return refused("a closed contact between parallel edges has no acceleration");
    Closed c{.touch = touch};
    const VecX slip = slip_of(touch, touch.u);
    c.along = VecX::Zero(slip.size());
    if (slip.size() > 0 && (touch.law.mu > 0 || !has_gap(touch)))
      c.friction = slip.norm() <= o_.stick_speed ? Friction::sticks : Friction::slips;
    if (c.friction == Friction::slips) c.along = slip.normalized();
    closed_.push_back(std::move(c));
  }
  const SmoothForces forces = smooth_forces(setting_, state_);
  const auto accelerate = [&] { return accelerations(setting_, state_, forces, closed_, {}); };
  Accelerations now = accelerate();
  if (!now.solved) return false;
  tolerance_ = kAcceleration * std::max(1.0, now.a.size() > 0 ? now.a.cwiseAbs().maxCoeff() : 0) +
               kAcceleration * model_.gravity.norm();
  bool again = false;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    Closed& c = closed_[i];
    if (c.friction != Friction::sticks) continue;
    const VecX slip = slip_of(c.touch, now.rate[i]);
    if (slip.norm() <= tolerance_ / 2 || (has_gap(c.touch) && now.force[i][0] <= 0)) continue;
    c.friction = Friction::slips;
    c.along = slip.normalized();
    again = true;
  }
  if (again && !(now = accelerate()).solved) return false;
  foretell_rest(now);
  a_ = all_velocities(setting_.dofs, now.a, VecX::Zero(state_.v.size()));
  std::vector<Closed> stay;
  force_.clear();
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (has_gap(closed_[i].touch) && now.force[i][0] <= 0 && now.rate[i][0] > tolerance_ / 2) {
      leaving_.push_back({closed_[i].touch, kLiftOff});
      continue;
    }
    stay.push_back(closed_[i]);
    force_.push_back(now.force[i]);
  }
  closed_ = std::move(stay);
  return true;
}

// Events of what was closed before.
void Run::compare(const std::vector<Closed>& before) {
  const std::vector<int> match = matched(touches_of(before), touches_of(closed_));
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (match[i] < 0) {
      add_event(EventKind::release, before[i].touch, state_.t);
      continue;
    }
    const Closed& now = closed_[std::size_t(match[i])];
    if (before[i].friction == Friction::sticks && now.friction == Friction::slips)
      add_event(EventKind::slip, now.touch, state_.t);
    if (before[i].friction != Friction::slips) continue;
    if (now.friction == Friction::sticks) add_event(EventKind::stick, now.touch, state_.t);
    if (now.friction == Friction::slips && now.along.dot(before[i].along) < -0.5 &&
        slip_of(now.touch, now.touch.u).norm() <= o_.stick_speed)
      add_event(EventKind::reversal, now.touch, state_.t);
  }
}

// Impacts, then what is closed and how, at the present state.
bool Run::settle(bool first) {
  move_prescribed();
  const std::vector<Closed> before = std::move(closed_);
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

VecX Run::packed() const {
  VecX y = VecX::Zero(layout_.size);
  int at = 0;
  for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
    if (setting_.dofs.first[b] < 0) continue;
    y.segment<3>(at) = state_.g[b].p;
    y.segment<4>(at + 3) = state_.g[b].R.coeffs();
    at += 7;
  }
  y.segment(layout_.q, state_.q.size()) = state_.q;
  y.segment(layout_.v, setting_.dofs.rows) = free_velocities(setting_.dofs, state_.v);
  return y;
}

State Run::unpacked(double t, const VecX& y) const {
  State out = state_;
  out.t = t;
  int at = 0;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {
    if (setting_.dofs.first[std::size_t(b)] >= 0) {
      pose(out, b).p = y.segment<3>(at);
      pose(out, b).R = Quat(Eigen::Vector4d(y.segment<4>(at + 3))).normalized();
      at += 7;
    } else if (const Vec6 v = twist(state_, b); !v.isZero(0)) {
      pose(out, b) = pose_at({.g = pose(state_, b), .v = v.head<3>(), .omega = v.tail<3>()}, t - state_.t);
    }
  }
  out.q = y.segment(layout_.q, state_.q.size());
  out.v = all_velocities(setting_.dofs, y.segment(layout_.v, setting_.dofs.rows), state_.v);
  if (!model_.joints.empty()) out.turns = counted_turns(model_, turned_, out.g);
  return out;
}

// The closed touches where they are now, their slip in the direction that continues the one they began with
// through zero, so that the rate is smooth there.
std::vector<Closed> Run::closed_at(const std::vector<Touch>& touches, std::vector<int>& match) const {
  match = matched(touches_of(closed_), touches);
  std::vector<Closed> out;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (match[i] < 0) continue;
    Closed c = closed_[i];
    c.touch = touches[std::size_t(match[i])];
    if (c.friction == Friction::slips) {
      const VecX slip = slip_of(c.touch, c.touch.u);
      const double sign = slip.dot(closed_[i].along) < 0 ? -1 : 1;
      c.along = (sign * slip + kDirection * closed_[i].along).normalized();
    }
    out.push_back(std::move(c));
  }
  return out;
}

bool Run::rate(double t, const VecX& y, VecX& out) const {
  const State s = unpacked(t, y);
  std::vector<int> match;
  const std::vector<Closed> closed = closed_at(touches_at(setting_, s, o_.horizon), match);
  const SmoothForces forces = smooth_forces(setting_, s);
  const Accelerations now = accelerations(setting_, s, forces, closed,
                                          closed.size() == force_.size() ? force_ : std::vector<VecX>{});
  if (!now.solved) return false;
  out.setZero();
  int at = 0;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {
    if (setting_.dofs.first[std::size_t(b)] < 0) continue;
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
  std::size_t k = 0;
  for (std::size_t i = 0; i < closed_.size(); ++i) {
    if (match[i] < 0) continue;
    const Touch& touch = closed[k].touch;
    const bool of_joint = touch.slot >= 0 && touch.slot < first_gap_row(model_);
    out[layout_.work + (of_joint ? by_joints : by_contacts)] += v.dot(touch.N * now.force[k]);
    out.segment(layout_.first_impulse[i], touch.law.rows) = now.force[k];
    ++k;
  }
  if (reaction_.size() > 0) {
    out[layout_.work + by_joints] += v.dot(joint_constraints(model_, s, setting_.dofs).G * now.reaction);
    out.segment(layout_.reaction, reaction_.size()) = now.reaction;
  }
  if (!model_.coordinates.empty())
    out[layout_.work + by_mass] = rate_along(model_, s, [&](const State& moved) -> VecX {
      return VecX::Constant(1, 0.5 * v.dot(mass_of(setting_, moved) * v));
    })[0];
  return true;
}

// (EVD-6): all that fall through zero where the piece ends.
bool Run::roots(double t, const VecX& y, VecX& out) const {
  const State s = unpacked(t, y);
  const std::vector<Touch> touches = touches_at(setting_, s, o_.horizon);
  std::vector<int> match;
  const std::vector<Closed> closed = closed_at(touches, match);
  std::vector<char> open(touches.size(), 1);
  for (const int m : match)
    if (m >= 0) open[std::size_t(m)] = 0;
  std::vector<Touch> left;
  for (const Leaving& l : leaving_) left.push_back(l.touch);
  std::vector<double> offset(touches.size(), -1);
  const std::vector<int> leaving = matched(left, touches);
  for (std::size_t i = 0; i < leaving.size(); ++i)
    if (leaving[i] >= 0) offset[std::size_t(leaving[i])] = leaving_[i].offset;

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
    const Closed& c = closed[k];
    const VecX &force = now.force[k], &rate = now.rate[k], &weight = now.weight[k];
    ++k;
    if (has_gap(c.touch)) release = std::abs(weight[0]) * force[0] - rate[0] + tolerance_;
    if (c.friction == Friction::slips) friction = slip_of(c.touch, c.touch.u).dot(closed_[i].along);
    if (c.friction == Friction::sticks) {
      const double grip = has_gap(c.touch) ? c.touch.law.mu * force[0] : c.touch.law.limit;
      VecX held = has_gap(c.touch) ? VecX(force.tail(force.size() - 1)) : force;
      if (c.touch.law.kind == LawKind::contensou) held[2] /= c.touch.law.radius;
      const double mean = weight.tail(held.size()).mean();
      friction = mean * (grip - held.norm()) - slip_of(c.touch, rate).norm() + tolerance_;
    }
  }
  return true;
}

// Are the bodies apart on the way between two states that are one internal step from each other? (EVD-10)
bool Run::certified(const State& from, const State& to, const std::function<State(double)>& at) {
  const double dt = to.t - from.t;
  const auto path = [&](const State& a, const State& b) {
    VecX v = VecX::Zero(a.v.size());
    for (int k = 0; k < int(model_.bodies.size()); ++k) {
      v.segment<3>(6 * k) = (pose(b, k).p - pose(a, k).p) / (b.t - a.t);
      v.segment<3>(6 * k + 3) = log_so3((pose(a, k).R.conjugate() * pose(b, k).R).normalized()) / (b.t - a.t);
    }
    return v;
  };
  double dilation = kInf, off = 0;
  for (const auto& shape : model_.shapes)
    if (shape->radius > 0) dilation = std::min(dilation, shape->radius);
  if (dilation == kInf) return true;
  const State middle = at(from.t + dt / 2), straight = glided(
                                                model_,
                                                [&] {
                                                  State s = from;
                                                  s.v = path(from, to);
                                                  return s;
                                                }(),
                                                dt / 2);
  for (std::size_t b = 0; b < model_.bodies.size(); ++b)
    off = std::max(off, (middle.g[b].p - straight.g[b].p).norm() +
                            setting_.bounds[b].radius * angle_between(middle.g[b].R, straight.g[b].R));
  const int pieces = std::clamp(int(std::ceil(std::sqrt(off / (kChord * dilation)))), 1, kMaxPieces);
  State a = from;
  for (int k = 1; k <= pieces; ++k) {
    const State b = k == pieces ? to : at(from.t + dt * k / pieces);
    const VecX v = path(a, b);
    const StepMotion motion{model_, a, v, b.t - a.t};
    const AdvancementOptions& o = o_.step.advancement;
    const StepCertificate proof =
        certify_step(motion, step_pairs(motion, setting_.bounds, o, o_.step.threads), setting_.bounds, {}, o,
                     o_.step.threads);
    report_.certificate_rounds += int(proof.rounds);
    if (!proof.failure.empty()) {
      report_.reason = proof.failure;
      return false;
    }
    report_.min_base_distance = std::min(report_.min_base_distance, proof.min_distance);
    a = b;
  }
  return true;
}

// Quadratures of the piece, once it is accepted.
void Run::take(const VecX& y) {
  for (int k = 0; k < kWorks; ++k) work_[k] += y[layout_.work + k];
  for (std::size_t i = 0; i < closed_.size(); ++i)
    add_impulse(closed_[i].touch, y.segment(layout_.first_impulse[i], closed_[i].touch.law.rows));
  if (reaction_.size() > 0) reaction_ += y.segment(layout_.reaction, reaction_.size());
}

// How far an internal step may go without passing through a body unseen: half a dilation with twice the speed
// and acceleration of now (EVD-10).
double Run::safe_until(const State& from, double stop) const {
  const double dt = stop - from.t;
  std::vector<double> speed, acceleration, reach;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {
    const double radius = setting_.bounds[std::size_t(b)].radius;
    const auto size = [&](const Vec6& v) { return 2 * (v.head<3>().norm() + radius * v.tail<3>().norm()); };
    speed.push_back(size(twist(from, b)));
    acceleration.push_back(size(a_.segment<6>(6 * b)));
    reach.push_back(o_.horizon + dt * (speed.back() + dt * acceleration.back() / 2));
  }
  double stride = kInf;
  for (const StepPair& pair : pairs_within(model_, from, setting_.bounds, reach, o_.step.threads)) {
    const auto sum = [&](const std::vector<double>& of) {
      return of[std::size_t(pair.a)] + of[std::size_t(pair.b)];
    };
    const double room = pair.dilation / 2;
    stride = std::min(stride, room / (sum(speed) + std::sqrt(room * (sum(acceleration) + kTiny))));
  }
  return std::min(stop, from.t + stride);
}

// Could a pair have passed through each other in an internal step?
bool Run::leapt(const State& from, const State& to) const {
  std::vector<double> moved;
  for (int b = 0; b < int(model_.bodies.size()); ++b)
    moved.push_back((pose(to, b).p - pose(from, b).p).norm() +
                    setting_.bounds[std::size_t(b)].radius * angle_between(pose(from, b).R, pose(to, b).R));
  for (const StepPair& pair : pairs_within(model_, from, setting_.bounds, moved, o_.step.threads))
    if (moved[std::size_t(pair.a)] + moved[std::size_t(pair.b)] > pair.dilation) return true;
  return false;
}

// From settled to the next stop.
bool Run::piece() {
  layout_ = layout_of(setting_, closed_, int(reaction_.size()));
  const double stop = next_row();
  const OdeProblem problem{
      .rate = [&](double t, const VecX& y, VecX& out) { return rate(t, y, out); },
      .roots = [&](double t, const VecX& y, VecX& out) { return roots(t, y, out); },
      .root_count = 1 + 2 * int(closed_.size()),
      .unjudged = layout_.size - layout_.impulse};  // redundant contacts share their load as they like
  OdeOptions ode = o_.ode;
  if (std::ranges::any_of(closed_, [&](const Closed& c) {
        return c.friction == Friction::slips && c.along.size() > 1 &&
               slip_of(c.touch, c.touch.u).norm() < o_.stiff_slip;
      }))
    ode.method = OdeMethod::bdf;
  for (int retry = 0; retry < kMaxRetries; ++retry) {
    turned_ = state_;
    OdePiece run(problem, ode, state_.t, packed());
    State last = state_;
    OdeStop what = OdeStop::stepped;
    bool proven = true;
    while (proven && what == OdeStop::stepped) {
      const double until = safe_until(last, stop);
      what = run.advance(until);
      if (what == OdeStop::at_end && until < stop) what = OdeStop::stepped;
      if (what == OdeStop::failed && ode.method == OdeMethod::adams) {
        ode.method = OdeMethod::bdf;  // stiffer than expected
        proven = false;
        break;
      }
      if (what == OdeStop::failed) return refused(run.reason());
      const State now = unpacked(run.time(), run.state());
      proven = !leapt(last, now);
      proven = proven && (!o_.step.advancement.certify || run.time() <= last.t ||
                          certified(last, now, [&](double t) { return unpacked(t, run.at(t)); }));
      if (!proven) ode.largest_step = (now.t - last.t) / 4;
      turned_ = last = now;
    }
    if (!proven) continue;
    take(run.state());
    state_.t = last.t, state_.g = last.g, state_.q = last.q, state_.v = last.v, state_.turns = last.turns;
    if (what == OdeStop::at_end) state_.t = stop;
    if (!model_.joints.empty()) state_ = consistent(model_, state_);  // (EVD-5)
    return true;
  }
  return refused("no path is proven to keep bodies apart: " + report_.reason);
}

StepReport Run::go(State& out) {
  const double begin = step_clock();
  const State start = state_;
  move_prescribed();
  const Energy before = energy(model_, state_);
  bool alive = state_.v.allFinite();
  if (!alive) report_.status = StepStatus::not_finite, report_.reason = "a velocity is not finite";
  alive = alive && settle(true);
  while (alive && state_.t < t_end_ - kSameTime) {
    if (++stops_ > o_.max_events) {
      std::ostringstream text;
      text << "more than " << o_.max_events << " events from t = " << start.t << " to " << state_.t << " s";
      alive = refused(text.str());
      break;
    }
    alive = piece() && settle(false);
  }
  report_.seconds_total = step_clock() - begin;
  report_.t = start.t;
  if (!alive) return report_;

  report_.reason.clear();
  state_.t = t_end_;
  state_.h = report_.h = t_end_ - start.t;
  state_.h_next = 0;
  report_.t = state_.t;
  report_.attempts = stops_;
  report_.contacts_found = report_.contacts_kept = int(report_.contacts.size());
  ContactSet acted;
  std::vector<Vec3> impulse;
  std::vector<double> drilling;
  for (const StepContact& c : report_.contacts) {
    acted.points.push_back(c.point);
    impulse.push_back(c.impulse);
    drilling.push_back(c.drilling);
    report_.min_gap = std::min(report_.min_gap, c.point.gap);
  }
  state_.memory = remember(acted, impulse, {.drilling = drilling, .anchors = {}, .g = start.g});
  if (!model_.joints.empty()) {
    const JointSystem joints = joint_system(model_, state_, setting_.dofs, VecX::Zero(state_.v.size()),
                                            report_.h, 1, o_.step.normal, o_.step.joints);
    report_.joints = step_joints(model_, joints, reaction_, state_.r, report_.h);
    report_.joint_error = joint_error(model_, state_);
  }
  const Energy after = energy(model_, state_);
  report_.energy = {.kinetic_change = after.kinetic - before.kinetic,
                    .gravity_work = before.gravity - after.gravity,
                    .law_work = work_[by_laws],
                    .contact_work = work_[by_contacts],
                    .gyroscopic_work = work_[by_mass],
                    .joint_work = work_[by_joints]};
  out = std::move(state_);
  return report_;
}

}  // namespace

const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::impact:
      return "impact";
    case EventKind::rest:
      return "rest";
    case EventKind::release:
      return "release";
    case EventKind::slip:
      return "slip";
    case EventKind::stick:
      return "stick";
    case EventKind::reversal:
      return "reversal";
    case EventKind::tangential_impact:
      return "tangential impact";
  }
  return "?";
}

void validate(const EventDrivenOptions& o) {
  validate(o.ode);
  require_field(o.horizon > 0, "EventDrivenOptions::horizon", o.horizon, "be positive [m]");
  require_field(o.gap_tolerance > 0 && o.gap_tolerance < o.horizon, "EventDrivenOptions::gap_tolerance",
                o.gap_tolerance, "be positive and below the horizon [m]");
  require_field(o.rest_speed > 0, "EventDrivenOptions::rest_speed", o.rest_speed, "be positive [m/s]");
  require_field(o.stick_speed > 0, "EventDrivenOptions::stick_speed", o.stick_speed, "be positive [m/s]");
  require_field(o.stiff_slip >= 0, "EventDrivenOptions::stiff_slip", o.stiff_slip, "not be negative [m/s]");
  require_field(o.max_events >= 1, "EventDrivenOptions::max_events", o.max_events, "be at least 1");
  refuse_anchors(o.step, "event_driven");
  validate(o.step);
}

EventDriven::EventDriven(const Model& model, const EventDrivenOptions& options)
    : setting_(step_setting(model, options.step)), options_(options) {
  validate(options);
  for (const Joint& joint : model.joints)
    for (const JointAxis& axis : joint.axis)
      require(axis.motor.kind == MotorKind::none || axis.motor.kind == MotorKind::effort ||
                  axis.motor.limit == kInf,
              "joint " + joint.name +
                  ": a motor of speed or position with a limit has no law on the level of "
                  "accelerations; event_driven knows it without limit only");
}

StepReport EventDriven::step(State& state, double h_limit) const {
  require_field(h_limit > 0, "h_limit", h_limit, "be positive [s]");
  return Run(setting_, options_, state, std::min(options_.step.h, h_limit)).go(state);
}

}  // namespace aussois
