// SPDX-License-Identifier: Apache-2.0
#include "integrators/events/event_driven.hpp"

#include <algorithm>
#include <sstream>

#include "geometry/named.hpp"
#include "geometry/settings.hpp"
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
  for (const BodyId b : model_.bodies.ids())
    if (const auto* motion = std::get_if<PrescribedMotion>(&model_.bodies[b].motion)) {
      const TrajectoryPoint now = trajectory_point(motion->path, state_.t + kSameTime);
      pose(state_, b) = now.pose;
      twist(state_, b) = now.twist;
    }
}

// The next time at which a prescribed velocity jumps.
double EventRun::next_row() const {
  double next = t_end_;
  for (const RigidBody& body : model_.bodies)
    if (const auto* motion = std::get_if<PrescribedMotion>(&body.motion))
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

// Goes step by step to `stop` or a root, each step proven; state_ is where it began. `last` is where it got
// to. False: it failed. Either `ode` has new options for another attempt, or the step is refused for good.
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
        !leapt(last, now) && (!setting_.options.advancement.certify || run.time() <= last.t ||
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
bool EventRun::integrate_piece() {
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
  const std::vector<BodyPair> driven = report_.driven_overlaps;
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
  const std::string wrong = setting_.options.advancement.certify
                                ? wrong_start(model_, state_, setting_.bounds, setting_.pieces,
                                              setting_.options.advancement, setting_.options.threads)
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
  proven_apart_ = is_proven_apart(model_, start);
  if (setting_.options.advancement.certify && !proven_apart_) {  // (CA-19)
    const std::string nested =
        nested_at(model_, state_, setting_.bounds, setting_.pieces, setting_.options.threads);
    if (!nested.empty()) return refused("start: " + nested);
  }
  if (!settle(true)) return false;
  while (state_.t < t_end_ - kSameTime) {
    if (++stops_ > o_.max_events) {
      std::ostringstream text;
      text << "more than " << o_.max_events << " events from t = " << start.t << " to " << state_.t << " s";
      return refused(text.str());
    }
    if (!integrate_piece() || !settle(false)) return false;
  }
  if (model_.joints.empty()) return true;
  const JointError off = joint_error(model_, state_);
  return within(off, setting_.options.joints) || refused(text_of(off, setting_.options.joints));
}

// Reports what contacts and joints did, and keeps what the next step needs of it.
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
  std::ranges::sort(report_.gaps, {}, &StepGap::id);
  report_.law_work.assign(setting_.laws.size(), 0);
  for (const StepContact& c : report_.contacts)
    add_law_work(setting_, contact_law(model_, c.point.a.body, c.point.b.body), c.work, report_);
  for (const StepGap& gap : report_.gaps) add_law_work(setting_, model_.gaps[gap.id].law, gap.work, report_);
}

StepReport EventRun::step(State& out) {
  const StageTime begin = time_now(setting_.options.profile);
  const State start = state_;
  move_prescribed();
  const Energy before = energy(model_, state_);
  const Momentum momentum_before = momentum(model_, state_);
  const bool done = run(start);
  report_.total = time_since(begin, setting_.options.profile);
  report_.t = start.t;
  if (!done) return report_;

  report_.reason.clear();
  state_.t = t_end_;
  state_.h = report_.h = t_end_ - start.t;
  state_.h_next = 0;
  state_.apart = setting_.options.advancement.certify ? placement(model_, state_) : 0;
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

constexpr Named<EventKind> kEventKinds[] = {{EventKind::impact, "impact"},
                                            {EventKind::rest, "rest"},
                                            {EventKind::release, "release"},
                                            {EventKind::slip, "slip"},
                                            {EventKind::stick, "stick"},
                                            {EventKind::reversal, "reversal"},
                                            {EventKind::tangential_impact, "tangential impact"}};

const char* to_string(EventKind kind) {
  return name_of(kind, kEventKinds);
}

void describe(SettingVisitor& visit, OdeOptions& o) {
  visit.begin("OdeOptions");
  visit.choice({"method", "integration method; bdf: for stiff springs"}, o.method, kOdeMethods);
  visit.number({.name = "relative",
                .what = "relative tolerance of the integration",
                .unit = "-",
                .range = open_range(0, 1),
                .flag = "--ode-relative",
                .label = "relative %"},
               o.relative);
  visit.number({.name = "absolute",
                .what = "absolute tolerance of the integration",
                .unit = "m, m/s, rad",
                .range = positive_range(),
                .flag = "--ode-absolute",
                .label = "absolute %"},
               o.absolute);
  visit.number({"largest_step", "largest step of the integration", "s", range_above(0)}, o.largest_step);
  visit.count(
      {"max_steps", "maximum number of integration steps in one step of the scheme", "", range_from(1)},
      o.max_steps);
}

void describe(SettingVisitor& visit, EventDrivenOptions& o) {
  visit.begin("EventDrivenOptions");
  visit.group("ode", o.ode);
  visit.number({"horizon", "gap below which a contact is watched", "m", positive_range()}, o.horizon);
  visit.number({"gap_tolerance", "gap below which a contact counts as closed", "m, rad", positive_range()},
               o.gap_tolerance);
  visit.number(
      {"rest_speed", "leaving speed below which a contact stays closed", "m/s, rad/s", positive_range()},
      o.rest_speed);
  visit.number({"stick_speed", "slip speed below which a contact may stick", "m/s, rad/s", positive_range()},
               o.stick_speed);
  visit.number({"stiff_slip", "initial slip speed below which a piece is integrated with bdf", "m/s",
                not_negative_range()},
               o.stiff_slip);
  visit.count({"max_events", "maximum number of events in one step", "", range_from(1)}, o.max_events);
  visit.number({"tolerance", "tolerance on the scaled residual of impacts and accelerations", "-",
                range_open_below(0, kAcceptedResidual)},
               o.tolerance);
}

void validate(const EventDrivenOptions& o) {
  check_ranges(o);
  require_field(o.gap_tolerance < o.horizon, "EventDrivenOptions::gap_tolerance", o.gap_tolerance,
                "be below the horizon [m]");
  require(o.ode.method == OdeMethod::adams || o.stiff_slip == EventDrivenOptions{}.stiff_slip,
          "EventDrivenOptions::stiff_slip = " + number_text(o.stiff_slip) +
              " is read by OdeOptions::method = adams only: bdf integrates every piece already");
}

namespace {

StepSetting setting_of(const Model& model, StepOptions step, const EventDrivenOptions& own) {
  validate(own);
  refuse_unread(step, EventDriven::unread(), "event_driven");
  step.solver.tolerance = own.tolerance;
  return step_setting(model, step);
}

}  // namespace

std::vector<std::string> EventDriven::unread() {
  std::vector<std::string> out{"correction_speed",
                               "touching",
                               "joints.stabilisation",
                               "joints.project",
                               "solver.tolerance",
                               "advancement.min_h",
                               "advancement.growth",
                               "advancement.max_attempts",
                               "update",
                               "keep_problem",
                               "levels"};
  static const std::vector<SettingValue> all = values_of(StepOptions{});
  for (const SettingValue& one : all)  // all contacts count, and none is matched
    if (one.path.starts_with("reduction.") || one.path.starts_with("persistence.")) out.push_back(one.path);
  return out;
}

EventDriven::EventDriven(const Model& model, const StepOptions& step, const EventDrivenOptions& own)
    : setting_(std::make_shared<const StepSetting>(setting_of(model, step, own))), own_(own) {
  refuse_deforming(model, "event_driven");
  for (const Joint& joint : model.joints)
    for (const JointAxis& axis : joint.axis)
      require(axis.motor.kind == MotorKind::none || axis.motor.kind == MotorKind::effort ||
                  axis.motor.limit == kInf,
              "joint " + joint.name +
                  ": a motor of speed or position with a limit has no law on the level of "
                  "accelerations; event_driven takes it without limit only");
}

StepReport EventDriven::step(State& state, double h_limit) const {
  check_fits(*setting_, state, h_limit);
  return EventRun(*setting_, own_, state, std::min(setting_->options.h, h_limit)).step(state);
}

}  // namespace aussois
