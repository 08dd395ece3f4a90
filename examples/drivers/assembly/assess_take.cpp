// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assess_take.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include <nlohmann/json.hpp>

#include "examples/common/kept_json.hpp"
#include "examples/drivers/assembly/jam_probe.hpp"
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
  Assessor(const SessionStage& stage, const RunHeader& header, const AssessOptions& options)
      : options_(options), last_(stage.state()) {
    if (options.folder.empty()) return;
    run_.emplace(options.folder / "run.h5", header);
    table_.emplace(
        options.folder / "ticks.csv",
        std::vector<std::string>{"tick", "t", "steps", "contacts", "touching", "min_gap", "clearance",
                                 "hand_force", "hand_torque", "contact_force", "largest_contact_force",
                                 "hand_work", "contact_work", "held", "whole"});
    run_->append(run_step(0, stage.model(), last_));
    add_pose(stage);
  }

  void add(const SessionStage& stage, const TickReport& report) {
    const State& state = stage.state();
    const Port& port = stage.port();
    const PortPull pull = port_pull(state, port);
    ++tick_;
    look_at_steps(report, port.body);
    look_at_hand(stage, pull);
    out.length += (pose(state, port.body).p - pose(last_, port.body).p).norm();
    out.rotation += angle_between(pose(state, port.body).R, pose(last_, port.body).R);
    if (run_ && tick_ % options_.every == 0) add_row(stage, report, pull);
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
                  : out.blocked >= 0.2                  ? look_for_a_way(stage)
                                                        : TakeVerdict::stopped;
    out.way = poses_.pose;
    if (!run_) return;
    run_->close();
    table_->close();
    if (poses_.pose.size() >= 2) write_poses(options_.folder / "path.csv", poses_, 1);
    RunReader recorded(options_.folder / "run.h5");
    write_replay_html(options_.folder / "replay.html", recorded);
  }

  TakeAssessment out{};

 private:
  // Which way a blocked part comes free, at the limits of the hand.
  TakeVerdict look_for_a_way(const SessionStage& stage) {
    const PortLimits& limits = stage.port().options.limits;
    const JamProbe probe = probe_jam(stage, {.force = std::min(limits.force, 1e3),
                                             .torque = std::min(limits.torque, 1e2),
                                             .enough = 0.1 * options_.clearance,
                                             .radius = options_.radius});
    out.free_way = probe.way, out.free_push = probe.name;
    return probe.wedged ? TakeVerdict::wedged : TakeVerdict::blocked;
  }

  void look_at_steps(const TickReport& report, BodyId body) {
    bool unsolved = false;
    double work = 0;
    if (fresh_row_)
      load_ = {}, clearance_ = kInf, gap_ = kInf, hand_ = 0;  // a row has what came since the last one
    fresh_row_ = false;
    for (const StepReport& step : report.steps) {
      const ContactLoad load = load_of(step, body);
      load_ = {std::max(load_.sum, load.sum), std::max(load_.largest, load.largest), load_.work + load.work,
               load.count};
      work += load.work;
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
    out.friction -= work;
  }

  // The handle has a constant velocity in a tick; the pull is taken as the mean of its ends.
  void look_at_hand(const SessionStage& stage, const PortPull& pull) {
    const State& state = stage.state();
    const Port& port = stage.port();
    const double tick = state.t - last_.t;
    const Vec6 lead = twist(state, port.handle);
    const Vec3 turning = pose(state, port.handle).R * Vec3(lead.tail<3>());
    out.work += tick / 2 *
                ((pull.force + last_pull_.force).dot(lead.head<3>()) +
                 (pull.torque + last_pull_.torque).dot(turning));
    hand_ = std::max(hand_, pull.force.norm());
    out.hand_force = std::max(out.hand_force, pull.force.norm());
    out.hand_torque = std::max(out.hand_torque, pull.torque.norm());
    const bool at_limit = is_at_limit(pull, port.options.limits);
    const double stride = port.options.stride * 2 * stage.parameters().dilation,
                 way = (pose(state, port.body).p - pose(last_, port.body).p).norm() +
                       options_.radius * angle_between(pose(state, port.body).R, pose(last_, port.body).R);
    blocked_ = at_limit && way < kAtRest * stride ? blocked_ + stage.parameters().tick : 0;
    out.blocked = std::max(out.blocked, blocked_);
  }

  void add_row(const SessionStage& stage, const TickReport& report, const PortPull& pull) {
    const State& state = stage.state();
    table_->add({double(tick_), state.t, double(report.steps.size()),
                 report.steps.empty() ? 0.0 : double(report.steps.back().contacts_found), double(load_.count),
                 gap_, clearance_, hand_, pull.torque.norm(), load_.sum, load_.largest, out.work,
                 -out.friction, double(is_held(state, stage.port())), double(report.whole())});
    const CouplingWrench wrench{.force = pull.force,
                                .torque = pose(state, stage.port().body).R.conjugate() * pull.torque};
    if (report.whole())
      run_->append(run_step(tick_, stage.model(), state, report.steps.back(), wrench));
    else
      run_->append(run_step(tick_, stage.model(), state, wrench));
    add_pose(stage);
    fresh_row_ = true;
  }

  // Of the mesh, as replay_assembly reads it.
  void add_pose(const SessionStage& stage) {
    const State& state = stage.state();
    if (!poses_.t.empty() && !(state.t > poses_.t.back())) return;
    poses_.t.push_back(state.t);
    poses_.pose.push_back(pose(state, stage.port().body) * stage.model().bodies[stage.port().body].g_bs);
  }

  const AssessOptions& options_;
  std::optional<RunWriter> run_{};
  std::optional<CsvTable> table_{};
  PoseFile poses_{};
  State last_;
  PortPull last_pull_{};
  ContactLoad load_{};
  bool fresh_row_ = true;
  double hand_ = 0;
  double clearance_ = kInf, gap_ = kInf, blocked_ = 0;
  std::int64_t tick_ = 0;
};

}  // namespace

TakeAssessment assess_take(const SessionLog& log, int take, SessionStage& stage, const RunHeader& header,
                           const AssessOptions& options) {
  Assessor assessor(stage, header, options);
  const TakeRepeat repeat =
      repeat_take(log, take, stage, [&](const SessionStage& now, const TickReport& report) {
        assessor.add(now, report);
        return !options.go_on || options.go_on(assessor.out.repeat.ticks++);
      });
  assessor.out.repeat = repeat;
  assessor.end(stage);
  return assessor.out;
}

const std::vector<AssessmentNumber>& assessment_numbers() {
  using A = TakeAssessment;
  const auto real = [](const char* name, const char* what, const char* unit, double A::*member) {
    return AssessmentNumber{name,
                            what,
                            unit,
                            false,
                            [member](const A& a) { return a.*member; },
                            [member](A& a, double x) { a.*member = x; }};
  };
  const auto count = [](const char* name, const char* what, auto member) {
    return AssessmentNumber{name,
                            what,
                            "",
                            true,
                            [member](const A& a) { return double(std::invoke(member, a)); },
                            [member](A& a, double x) { std::invoke(member, a) = std::int64_t(x); }};
  };
  static const std::vector<AssessmentNumber> all{
      count(
          "ticks", "ticks", [](auto& a) -> auto& { return a.repeat.ticks; }),
      count(
          "hashes", "hashes compared", [](auto& a) -> auto& { return a.repeat.hashes; }),
      count(
          "differs", "first moment with another hash, -1: none",
          [](auto& a) -> auto& { return a.repeat.differs; }),
      count("refused_ticks", "ticks whose rest was refused", &A::refused),
      count("unsolved_ticks", "ticks with a problem that was not solved", &A::unsolved),
      real("lag", "farthest point of the part behind its goal, at the end", "m", &A::lag),
      real("blocked_time", "longest time at rest with the pull at its limit", "s", &A::blocked),
      real("clearance", "least distance of the meshes, lower bound", "m", &A::clearance),
      real("clearance_time", "time of that", "s", &A::clearance_t),
      real("first_touch", "first contact force", "s", &A::touched),
      real("hand_force", "largest force of the hand", "N", &A::hand_force),
      real("hand_torque", "largest torque of the hand", "N m", &A::hand_torque),
      real("contact_force", "largest sum of contact forces on the part", "N", &A::contact_force),
      real("largest_contact_force", "largest force of one contact", "N", &A::contact),
      real("hand_work", "work of the hand", "J", &A::work),
      real("contact_losses", "taken by contacts", "J", &A::friction),
      real("length", "way of the part's centre", "m", &A::length),
      real("rotation", "its rotation, summed", "rad", &A::rotation),
      real("free_way", "way of a blocked part by the best push", "m", &A::free_way)};
  return all;
}

void set_assessment(const TakeAssessment& a, Summary& summary) {
  summary.set("verdict", name_of(a.verdict, kTakeVerdicts));
  summary.set("free_push", a.free_push);
  for (const AssessmentNumber& number : assessment_numbers()) {
    if (number.whole)
      summary.set(number.name, std::int64_t(number.get(a)));
    else
      summary.set(number.name, number.get(a));
  }
}

nlohmann::ordered_json json_of(const TakeAssessment& a) {
  nlohmann::ordered_json out{{"verdict", name_of(a.verdict, kTakeVerdicts)}, {"free_push", a.free_push}};
  for (const AssessmentNumber& number : assessment_numbers()) out[number.name] = number_json(number.get(a));
  return out;
}

TakeAssessment assessment_in(const nlohmann::ordered_json& json) {
  TakeAssessment out;
  out.verdict = value_named(json.at("verdict").get<std::string>(), "verdict", kTakeVerdicts);
  out.free_push = json.at("free_push").get<std::string>();
  for (const AssessmentNumber& number : assessment_numbers())
    number.set(out, number_in(json.at(number.name)));
  return out;
}

std::string to_string(const TakeAssessment& a) {
  char text[400];
  std::snprintf(text, sizeof text,
                "%s: %lld ticks, meshes at least %.4g um apart (at %.4g s), hand up to %.3g N and %.3g N m, "
                "contacts up to %.3g N, work %.3g J, way %.4g mm and %.4g deg",
                name_of(a.verdict, kTakeVerdicts), static_cast<long long>(a.repeat.ticks), 1e6 * a.clearance,
                a.clearance_t, a.hand_force, a.hand_torque, a.contact_force, a.work, 1e3 * a.length,
                180 / kPi * a.rotation);
  std::string out = text;
  if (a.free_way > 0) {
    std::snprintf(text, sizeof text, "; pushed %s it moves by %.3g um", a.free_push.c_str(),
                  1e6 * a.free_way);
    out += text;
  }
  return out;
}

}  // namespace aussois
