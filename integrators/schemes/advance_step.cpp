// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/advance_step.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <tuple>
#include <utility>

#include "geometry/all_finite.hpp"
#include "geometry/named.hpp"
#include "integrators/prove/certify_step.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/motion.hpp"

namespace aussois {

constexpr Named<StepStatus> kStepStatuses[] = {{StepStatus::ok, "ok"},
                                               {StepStatus::not_solved, "not solved"},
                                               {StepStatus::refused, "refused"},
                                               {StepStatus::not_finite, "not finite"}};

const char* to_string(StepStatus status) {
  return name_of(status, kStepStatuses);
}

namespace {

// What a step tries next: how long, and with which estimate of where bodies may be.
struct Search {
  double h_limit = 0, h_control = 0;  // what may be tried, what the control chose [s]
  double growth = 1, min_h = 0;
  double h = 0;
  Estimate estimate{};
  int unsolved = 0, enlarged = 0;

  void halve() {  // in half the time other pairs meet, or none
    h /= 2;
    estimate.meeting.clear();
  }
  bool may_halve() const { return h / 2 >= min_h; }
  double next() const {  // only a cut step makes it smaller
    return h < std::min(h_control, h_limit) ? growth * h : std::max(h_control, growth * h);
  }
  // Prepares another attempt; false if the judgement ends them.
  bool goes_on(const Judgement& judgement);
};

bool Search::goes_on(const Judgement& judgement) {
  switch (judgement.objection.outcome) {
    case Outcome::accepted:
      return false;
    case Outcome::not_finite:  // the linear gyroscopic term of a long step can make M^ indefinite
      if (!may_halve()) return false;
      halve();
      return true;
    case Outcome::not_solved:  // a shorter step is an easier problem; after that the report shows it
      if (++unsolved > 3 || !may_halve()) return false;
      halve();
      return true;
    case Outcome::bound_exceeded:
      estimate.v = judgement.v_path;
      if (++enlarged % 4 == 0) halve();
      return true;
    case Outcome::meets: {
      std::vector<BodyPair> all;
      std::ranges::set_union(estimate.meeting, judgement.objection.meeting, std::back_inserter(all));
      estimate.meeting = std::move(all);
      return true;
    }
    case Outcome::levels_meet_far:
      if (may_halve()) {
        halve();
        return true;
      }
      [[fallthrough]];
    case Outcome::levels_meet:  // each time farther: guards are beyond half of what the shapes answered to
      for (const auto& [bodies, gap] : judgement.objection.fine_to) estimate.fine_to[bodies] = gap;
      return true;
    case Outcome::not_certified:
      halve();
      return true;
  }
  return false;
}

// Of a judgement that ends the attempts.
StepStatus status_of(const Judgement& judgement) {
  return judgement.objection.outcome == Outcome::accepted     ? StepStatus::ok
         : judgement.objection.outcome == Outcome::not_solved ? StepStatus::not_solved
                                                              : StepStatus::not_finite;
}

// Why no step can begin here; ok: one can.
std::pair<StepStatus, std::string> wrong_from_here(const StepSetting& setting, const State& state,
                                                   const VecX& estimate, bool proven_apart) {
  if (!all_finite(estimate) || !all_finite(state.g)) {
    std::string none = force_refusal(setting.model, state);
    return {StepStatus::not_finite,
            none.empty() ? "a force, velocity or pose is not finite" : std::move(none)};
  }
  if (std::string off = joint_that_is_off(setting, state); !off.empty())
    return {StepStatus::refused, std::move(off)};
  if (setting.options.advancement.certify && !proven_apart) {  // else the certificate did (CA-19)
    const std::string nested =
        nested_at(setting.model, state, setting.bounds, setting.pieces, setting.options.threads);
    if (!nested.empty()) return {StepStatus::refused, "start: " + nested};
  }
  return {StepStatus::ok, ""};
}

// Why all attempts failed.
std::string refusal(const StepSetting& setting, const State& state, double min_h, const std::string& reason) {
  const AdvancementOptions& o = setting.options.advancement;
  std::ostringstream text;
  text << "no step of at least " << min_h << " s was accepted: ";
  const std::string wrong = o.certify ? wrong_start(setting.model, state, setting.bounds, setting.pieces, o,
                                                    setting.options.threads)
                                      : "";
  text << (wrong.empty() ? reason : "start: " + wrong);
  return text.str();
}

}  // namespace

StepReport advance_step(const StepSetting& setting, State& state, double h_limit, const StepMethod& method) {
  const AdvancementOptions& o = setting.options.advancement;
  check_fits(setting, state, h_limit);
  const bool cpu = setting.options.profile;
  const StageTime begin = time_now(cpu);
  const double h_largest = setting.options.h;
  Search search{.h_limit = h_limit,
                .h_control = state.h_next > 0 ? std::min(h_largest, state.h_next) : h_largest,
                .growth = o.growth};
  search.h = std::min(search.h_control, h_limit);
  search.min_h = std::min(o.min_h, search.h);  // what is left of a run may be shorter than any minimum
  StageTimes stages;
  StageClock assembly(Stage::assembly, cpu);
  search.estimate.v = with_carried(setting.model, state, method.estimate(state, search.h), search.h);
  assembly.add_to(stages);

  StepReport report{.t = state.t};
  const auto ended = [&](StepStatus status) {
    report.status = status;
    report.stages = stages;
    report.total = time_since(begin, cpu);
    report.kept_bytes = bytes_of(*setting.scratch);
    return std::move(report);
  };
  const bool proven_apart = is_proven_apart(setting.model, state);
  StepStatus begins;
  std::tie(begins, report.reason) = wrong_from_here(setting, state, search.estimate.v, proven_apart);
  if (begins != StepStatus::ok) return ended(begins);
  for (int k = 1;; ++k) {
    const Trial trial = method.attempt(state, search.estimate, search.h);
    Judgement judgement = judge(setting, state, trial, proven_apart);
    for (const StageTimes& part : {trial.found.times, trial.impulses.times, judgement.times})
      add(part, stages);
    const bool again = search.goes_on(judgement);
    if (again && k < o.max_attempts && search.h >= search.min_h) continue;
    const bool taken = !again && may_be_taken(judgement);
    const StepStatus status = again ? StepStatus::refused : status_of(judgement);
    StepResult result = tell(setting, state, trial, std::move(judgement));
    report = std::move(result.report);
    report.attempts = k;
    if (again) {
      report.t = state.t, report.h = 0;
      report.reason = refusal(setting, state, search.min_h, report.reason);
    }
    if (taken) {
      state = std::move(result.next);
      state.apart = o.certify ? placement(setting.model, state) : 0;
      // Shorter steps were no easier, so the next one need not be short.
      state.h_next = status == StepStatus::not_solved ? search.h_control : search.next();
    }
    return ended(status);
  }
}

}  // namespace aussois
