// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assess_take.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "io/csv_table.hpp"
#include "io/pose_file.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"
#include "mechanics/model.hpp"

namespace aussois {
namespace {

constexpr double kAtRest = 0.01;  // of a stride in a tick

// Forces of a step on a body.
struct ContactLoad {
  double sum = 0, largest = 0, work = 0;
  int count = 0;
};
ContactLoad load_of(const StepReport& step, BodyId body) {
  ContactLoad out;
  Vec3 sum = Vec3::Zero();
  for (const StepContact& c : step.contacts) {
    const bool on_a = c.point.a.body == body;
    if (!on_a && c.point.b.body != body) continue;
    sum += on_a ? c.impulse : Vec3(-c.impulse);
    out.largest = std::max(out.largest, c.impulse.norm() / step.h);
    out.work += c.work;
    out.count += !c.impulse.isZero(0);
  }
  out.sum = step.h > 0 ? sum.norm() / step.h : 0;
  return out;
}

class Assessor {
 public:
  Assessor(const SessionStage& stage, RunHeader header, const AssessOptions& options)
      : options_(options),
        run_(options.folder / "run.h5", header),
        table_(options.folder / "ticks.csv",
               {"tick", "t", "steps", "contacts", "touching", "min_gap", "clearance", "hand_force",
                "hand_torque", "contact_force", "largest_contact_force", "hand_work", "contact_work", "held",
                "whole"}),
        last_(stage.state()) {
    run_.append(run_step(0, stage.model(), last_));
    add_pose(stage);
  }

  void add(const SessionStage& stage, const TickReport& report) {
    const State& state = stage.state();
    const Port& port = stage.port();
    const PortPull pull = pull_of(stage);
    ++tick_;
    look_at_steps(report, port.body);
    look_at_hand(stage, pull);
    out.length += (pose(state, port.body).p - pose(last_, port.body).p).norm();
    out.rotation += angle_between(pose(state, port.body).R, pose(last_, port.body).R);
    if (tick_ % options_.every == 0) add_row(stage, report, pull);
    last_ = state;
    last_pull_ = pull;
  }

  void end(const SessionStage& stage) {
    if (options_.goal) {
      const SE3 &is = pose(stage.state(), stage.port().body), goal = options_.goal->pose;
      out.lag = (goal.p - is.p).norm() + options_.radius * angle_between(goal.R, is.R);
    }
    out.verdict = out.refused > 0                       ? TakeVerdict::refused
                  : out.unsolved > 0                    ? TakeVerdict::unsolved
                  : !options_.goal                      ? TakeVerdict::ended
                  : out.lag <= options_.goal->tolerance ? TakeVerdict::arrived
                  : out.blocked >= 0.2                  ? TakeVerdict::blocked
                                                        : TakeVerdict::stopped;
    run_.close();
    table_.close();
    if (poses_.pose.size() >= 2) write_poses(options_.folder / "path.csv", poses_, 1);
    RunReader recorded(options_.folder / "run.h5");
    write_replay_html(options_.folder / "replay.html", recorded);
  }

  TakeAssessment out{};

 private:
  static PortPull pull_of(const SessionStage& stage) {
    const State& s = stage.state();
    const Port& p = stage.port();
    return port_pull({pose(s, p.body), twist(s, p.body)}, {pose(s, p.handle), twist(s, p.handle)},
                     port_hold(s, p.place), p.options.limits);
  }

  void look_at_steps(const TickReport& report, BodyId body) {
    bool unsolved = false;
    load_ = {};
    clearance_ = kInf, gap_ = kInf;
    for (const StepReport& step : report.steps) {
      const ContactLoad load = load_of(step, body);
      load_ = {std::max(load_.sum, load.sum), std::max(load_.largest, load.largest), load_.work + load.work,
               load.count};
      unsolved = unsolved || (step.moved() && !step.ok());
      clearance_ = std::min(clearance_, step.min_base_distance);
      gap_ = std::min(gap_, step.min_gap);
      if (step.min_base_distance < out.clearance)
        out.clearance = step.min_base_distance, out.clearance_t = step.t;
      if (load.count > 0) out.touched = std::min(out.touched, step.t);
    }
    out.refused += !report.whole();
    out.unsolved += unsolved;
    out.contact_force = std::max(out.contact_force, load_.sum);
    out.contact = std::max(out.contact, load_.largest);
    out.friction -= load_.work;
  }

  // The handle has a constant velocity in a tick; the pull is taken as the mean of its ends.
  void look_at_hand(const SessionStage& stage, const PortPull& pull) {
    const State& state = stage.state();
    const Port& port = stage.port();
    const double tick = state.t - last_.t;
    const Vec6 lead = twist(state, port.handle);
    const Vec3 turning = pose(state, port.handle).R * Vec3(lead.tail<3>());
    work_ = tick / 2 *
            ((pull.force + last_pull_.force).dot(lead.head<3>()) +
             (pull.torque + last_pull_.torque).dot(turning));
    out.work += work_;
    out.hand_force = std::max(out.hand_force, pull.force.norm());
    out.hand_torque = std::max(out.hand_torque, pull.torque.norm());
    const bool at_limit = pull.force.norm() >= (1 - 1e-9) * port.options.limits.force ||
                          pull.torque.norm() >= (1 - 1e-9) * port.options.limits.torque;
    const double stride = port.options.stride * 2 * stage.parameters().dilation,
                 way = (pose(state, port.body).p - pose(last_, port.body).p).norm() +
                       options_.radius * angle_between(pose(state, port.body).R, pose(last_, port.body).R);
    blocked_ = at_limit && way < kAtRest * stride ? blocked_ + stage.parameters().tick : 0;
    out.blocked = std::max(out.blocked, blocked_);
  }

  void add_row(const SessionStage& stage, const TickReport& report, const PortPull& pull) {
    const State& state = stage.state();
    table_.add({double(tick_), state.t, double(report.steps.size()),
                report.steps.empty() ? 0.0 : double(report.steps.back().contacts_found), double(load_.count),
                gap_, clearance_, pull.force.norm(), pull.torque.norm(), load_.sum, load_.largest, out.work,
                -out.friction, double(is_held(state, stage.port())), double(report.whole())});
    const CouplingWrench wrench{.force = pull.force,
                                .torque = pose(state, stage.port().body).R.conjugate() * pull.torque};
    if (report.whole())
      run_.append(run_step(tick_, stage.model(), state, report.steps.back(), wrench));
    else
      run_.append(run_step(tick_, stage.model(), state, wrench));
    add_pose(stage);
  }

  // Of the mesh, as replay_assembly reads it.
  void add_pose(const SessionStage& stage) {
    const State& state = stage.state();
    if (!poses_.t.empty() && !(state.t > poses_.t.back())) return;
    poses_.t.push_back(state.t);
    poses_.pose.push_back(pose(state, stage.port().body) * stage.model().bodies[stage.port().body].g_bs);
  }

  const AssessOptions& options_;
  RunWriter run_;
  CsvTable table_;
  PoseFile poses_{};
  State last_;
  PortPull last_pull_{};
  ContactLoad load_{};
  double clearance_ = kInf, gap_ = kInf, work_ = 0, blocked_ = 0;
  std::int64_t tick_ = 0;
};

}  // namespace

TakeAssessment assess_take(const SessionLog& log, int take, SessionStage& stage, RunHeader header,
                           const AssessOptions& options) {
  Assessor assessor(stage, std::move(header), options);
  const TakeRepeat repeat =
      repeat_take(log, take, stage, [&](const SessionStage& now, const TickReport& report) {
        assessor.add(now, report);
        return !options.go_on || options.go_on(assessor.out.repeat.ticks++);
      });
  assessor.out.repeat = repeat;
  assessor.end(stage);
  return assessor.out;
}

void set_assessment(const TakeAssessment& a, Summary& summary) {
  summary.set("verdict", name_of(a.verdict, kTakeVerdicts));
  summary.set("ticks", a.repeat.ticks);
  summary.set("hashes", a.repeat.hashes);
  summary.set("differs", a.repeat.differs);
  summary.set("refused_ticks", a.refused);
  summary.set("unsolved_ticks", a.unsolved);
  summary.set("lag", a.lag);
  summary.set("blocked_time", a.blocked);
  summary.set("clearance", a.clearance);
  summary.set("clearance_time", a.clearance_t);
  summary.set("first_touch", a.touched);
  summary.set("hand_force", a.hand_force);
  summary.set("hand_torque", a.hand_torque);
  summary.set("contact_force", a.contact_force);
  summary.set("largest_contact_force", a.contact);
  summary.set("hand_work", a.work);
  summary.set("contact_losses", a.friction);
  summary.set("length", a.length);
  summary.set("rotation", a.rotation);
}

std::string to_string(const TakeAssessment& a) {
  char text[400];
  std::snprintf(text, sizeof text,
                "%s: %lld ticks, meshes at least %.4g um apart (at %.4g s), hand up to %.3g N and %.3g N m, "
                "contacts up to %.3g N, work %.3g J, way %.4g mm and %.4g deg",
                name_of(a.verdict, kTakeVerdicts), static_cast<long long>(a.repeat.ticks), 1e6 * a.clearance,
                a.clearance_t, a.hand_force, a.hand_torque, a.contact_force, a.work, 1e3 * a.length,
                180 / kPi * a.rotation);
  return text;
}

}  // namespace aussois
