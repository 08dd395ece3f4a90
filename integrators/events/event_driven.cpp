// SPDX-License-Identifier: Apache-2.0
#include "integrators/events/event_driven.hpp"

#include <algorithm>
#include <sstream>

#include "geometry/check.hpp"
#include "integrators/events/event_run.hpp"
#include "integrators/prove/certify_step.hpp"
#include "integrators/tell/ledgers.hpp"

namespace aussois {
namespace {

constexpr int kMaxRetries = 20;
constexpr double kTolerated = 0.1;  // time that may bring an error of the tolerances [s] (EVD-12)
constexpr double kFinest = 1e-14;   // relative tolerance: what is finer is lost in rounding

// A start costs an error of the tolerances, however short what follows. Both tolerances shrink alike: their
// ratio is the size of a component below which it is no longer judged by itself.
OdeOptions for_a_step(OdeOptions o, double h) {
  const double part = std::min(1.0, std::max(h / kTolerated, kFinest / o.relative));
  o.relative *= part;
  o.absolute *= part;
  return o;
}

}  // namespace

// Prescribed bodies stand and move where their paths say.
void EventRun::move_prescribed() {
  for (int b = 0; b < int(model_.bodies.size()); ++b)
    if (const auto* motion = std::get_if<Prescribed>(&model_.bodies[std::size_t(b)].motion)) {
      const TrajectoryPoint now = evaluate(motion->path, state_.t + kSameTime);
      pose(state_, b) = now.pose;
      twist(state_, b) = now.twist;
    }
}

// The next time at which a prescribed velocity jumps.
double EventRun::next_row() const {
  double next = t_end_;
  for (const RigidBody& body : model_.bodies)
    if (const auto* motion = std::get_if<Prescribed>(&body.motion))
      if (const auto row = std::ranges::upper_bound(motion->path.t, state_.t + kSameTime);
          row != motion->path.t.end() && *row < t_end_ - kSameTime)
        next = std::min(next, *row);
  return next;
}

// BDF where friction turns a slow slip faster than the motion goes.
OdeOptions EventRun::ode_of_piece() const {
  OdeOptions out = for_a_step(o_.ode, t_end_ - t_begin_);
  if (std::ranges::any_of(closed_, [&](const ClosedTouch& c) {
        return c.friction == FrictionState::slips && c.along.size() > 1 &&
               slip_of(c.touch, c.touch.u).norm() < o_.stiff_slip;
      }))
    out.method = OdeMethod::bdf;
  return out;
}

// Step by step to `stop` or a root, each step proven; state_ is where it began. `last` is where it got to;
// false: it got nowhere, for want of a proof with other options in `ode`, or for good, then it is refused.
bool EventRun::follow(const OdeProblem& problem, double stop, OdeOptions& ode, State& last, bool& refusal) {
  OdePiece run(problem, ode, state_.t, packed());
  OdeStop what = OdeStop::stepped;
  while (what == OdeStop::stepped) {
    const double until = safe_until(last, stop);
    if (ode_steps_++ == o_.ode.max_steps) {
      std::ostringstream text;
      text << "more than " << o_.ode.max_steps << " steps of the differential equation from t = " << t_begin_
           << " to " << last.t << " s";
      refusal = !refused(text.str());
      return false;
    }
    what = run.advance(until);
    if (what == OdeStop::at_end && until < stop) what = OdeStop::stepped;
    if (what == OdeStop::failed) {
      if (ode.method == OdeMethod::adams)
        ode.method = OdeMethod::bdf;  // stiffer than expected
      else
        refusal = !refused(run.reason());
      return false;
    }
    const State now = unpacked(run.time(), run.state());
    const bool proven =
        !leapt(last, now) && (!o_.step.advancement.certify || run.time() <= last.t ||
                              certified(last, now, [&](double t) { return unpacked(t, run.at(t)); }));
    if (!proven) {
      ode.largest_step = (now.t - last.t) / 4;
      return false;
    }
    turned_ = last = now;
  }
  take(run.state());
  if (what == OdeStop::at_end) last.t = stop;
  return true;
}

// From settled to the next stop.
bool EventRun::piece() {
  layout_ = layout_of(setting_, closed_);
  const OdeProblem problem{
      .rate = [&](double t, const VecX& y, VecX& out) { return rate(t, y, out); },
      .roots = [&](double t, const VecX& y, VecX& out) { return roots(t, y, out); },
      .root_count = 1 + 2 * int(closed_.size()),
      .unjudged = layout_.touch_work - layout_.impulse,  // redundant contacts share their load as they like
      .sums = layout_.size - layout_.touch_work};
  const double stop = next_row();
  OdeOptions ode = ode_of_piece();
  const std::size_t gone = report_.pieces.size();
  const std::vector<std::pair<int, int>> driven = report_.driven_overlaps;
  for (int retry = 0; retry < kMaxRetries; ++retry) {
    report_.pieces.resize(gone);
    report_.driven_overlaps = driven;
    turned_ = state_;
    State last = state_;
    bool refusal = false;
    if (follow(problem, stop, ode, last, refusal)) {
      state_.t = last.t, state_.g = last.g, state_.q = last.q, state_.v = last.v, state_.turns = last.turns;
      return true;
    }
    if (refusal) return false;
  }
  const std::string wrong = o_.step.advancement.certify
                                ? wrong_start(model_, state_, setting_.bounds, setting_.pieces,
                                              o_.step.advancement, o_.step.threads)
                                : "";
  std::ostringstream text;
  text << "no path from t = " << state_.t
       << " s is proven to keep bodies apart: " << (wrong.empty() ? report_.reason : wrong);
  return refused(text.str());
}

// From stop to stop; false: refused.
bool EventRun::run(const State& start) {
  if (!state_.v.allFinite()) {
    report_.status = StepStatus::not_finite, report_.reason = "a velocity is not finite";
    return false;
  }
  if (const std::string off = joint_that_is_off(setting_, state_); !off.empty()) return refused(off);
  if (o_.step.advancement.certify && start.h == 0) {  // (CA-19)
    const std::string nested = nested_at(model_, state_, setting_.bounds, setting_.pieces, o_.step.threads);
    if (!nested.empty()) return refused("start: " + nested);
  }
  if (!settle(true)) return false;
  while (state_.t < t_end_ - kSameTime) {
    if (++stops_ > o_.max_events) {
      std::ostringstream text;
      text << "more than " << o_.max_events << " events from t = " << start.t << " to " << state_.t << " s";
      return refused(text.str());
    }
    if (!piece() || !settle(false)) return false;
  }
  if (model_.joints.empty()) return true;
  const JointError off = joint_error(model_, state_);
  return within(off, o_.step.joints) || refused(text_of(off, o_.step.joints));
}

// What contacts and joints did, and what the next step is to know of it.
void EventRun::tell_contacts(const State& start) {
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
    report_.joints = std::move(joints_);
    for (StepJoint& joint : report_.joints)
      for (Vec3* mean : {&joint.force, &joint.torque, &joint.effort}) *mean /= report_.h;
    report_.t_joints = start.t + report_.h / 2;
    report_.joint_error = joint_error(model_, state_);
  }
  std::ranges::sort(report_.gaps, {}, &StepGap::index);
  report_.law_work.assign(setting_.laws.size(), 0);
  for (const StepContact& c : report_.contacts)
    add_work(setting_, contact_law(model_, c.point.a.body, c.point.b.body), c.work, report_);
  for (const StepGap& gap : report_.gaps)
    add_work(setting_, model_.gaps[std::size_t(gap.index)].law, gap.work, report_);
}

StepReport EventRun::step(State& out) {
  const double begin = step_clock();
  const State start = state_;
  move_prescribed();
  const Energy before = energy(model_, state_);
  const Momentum momentum_before = momentum(model_, state_);
  const bool done = run(start);
  report_.seconds_total = step_clock() - begin;
  report_.t = start.t;
  if (!done) return report_;

  report_.reason.clear();
  state_.t = t_end_;
  state_.h = report_.h = t_end_ - start.t;
  state_.h_next = 0;
  report_.t = state_.t;
  report_.attempts = stops_;
  tell_contacts(start);
  const Energy after = energy(model_, state_);
  report_.energy = {.kinetic_change = after.kinetic - before.kinetic,
                    .gravity_work = before.gravity - after.gravity,
                    .law_work = work_[by_laws],
                    .contact_work = work_[by_contacts],
                    .gyroscopic_work = work_[by_mass],
                    .joint_work = work_[by_joints]};
  report_.momentum = momentum_;  // (EVD-11)
  report_.momentum.change = momentum(model_, state_) - momentum_before;
  out = std::move(state_);
  return report_;
}

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
  require(
      o.step.reduction.friction == FrictionAt::contacts,
      "ReductionOptions::friction must be contacts with event_driven, whose contacts stand for themselves");
}

EventDriven::EventDriven(const Model& model, const EventDrivenOptions& options)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, options.step))), options_(options) {
  validate(options);
  refuse_deforming(model, "event_driven");
  for (const Joint& joint : model.joints)
    for (const JointAxis& axis : joint.axis)
      require(axis.motor.kind == MotorKind::none || axis.motor.kind == MotorKind::effort ||
                  axis.motor.limit == kInf,
              "joint " + joint.name +
                  ": a motor of speed or position with a limit has no law on the level of "
                  "accelerations; event_driven knows it without limit only");
}

StepReport EventDriven::step(State& state, double h_limit) const {
  check_fits(*setting_, state, h_limit);
  return EventRun(*setting_, options_, state, std::min(options_.step.h, h_limit)).step(state);
}

}  // namespace aussois
