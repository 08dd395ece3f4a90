// SPDX-License-Identifier: Apache-2.0
#include "integrators/advance_step.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

namespace aussois {

const char* to_string(StepStatus status) {
  switch (status) {
    case StepStatus::ok:
      return "ok";
    case StepStatus::not_solved:
      return "not solved";
    case StepStatus::refused:
      return "refused";
    case StepStatus::not_finite:
      return "not finite";
  }
  return "?";
}

StepReport advance_step(const StepSetting& setting, State& state, double h_limit, const StepMethod& method) {
  const AdvancementOptions& o = setting.options.advancement;
  const double h_largest = setting.options.h;
  check_fits(setting, state, h_limit);
  const double begin = step_clock();
  const double h_control = state.h_next > 0 ? std::min(h_largest, state.h_next) : h_largest;
  double h = std::min(h_control, h_limit);
  const double h_asked = h,
               min_h = std::min(o.min_h, h);  // what is left of a run may be shorter than any minimum
  Estimate estimate{.v = method.estimate(state, h)};

  const bool finite_poses =
      std::ranges::all_of(state.g, [](const SE3& g) { return g.p.allFinite() && g.R.coeffs().allFinite(); });
  StepReport report;
  const auto ended = [&](StepStatus status) {
    report.status = status;
    report.seconds_total = step_clock() - begin;
    if (!report.moved()) report.t = state.t, report.h = 0;
    return std::move(report);
  };
  if (!estimate.v.allFinite() || !finite_poses) {
    report.reason = "a force, velocity or pose is not finite";
    return ended(StepStatus::not_finite);
  }
  report.reason = joint_that_is_off(setting, state);
  if (!report.reason.empty()) return ended(StepStatus::refused);
  if (o.certify && state.h == 0) {  // from here on the certificate keeps surfaces apart (CA-19)
    report.reason = nested_at(setting.model, state, setting.bounds, setting.pieces, setting.options.threads);
    if (!report.reason.empty()) {
      report.reason = "start: " + report.reason;
      return ended(StepStatus::refused);
    }
  }
  int unsolved = 0, enlarged = 0;
  const auto halve = [&] {  // in half the time other pairs meet, or none
    h /= 2;
    estimate.meeting.clear();
  };
  for (int k = 1; k <= o.max_attempts && h >= min_h; ++k) {
    Attempt trial = method.attempt(state, estimate, h);
    report = std::move(trial.report);
    report.attempts = k;
    switch (trial.outcome) {
      case Outcome::not_finite:  // the linear gyroscopic term of a long step can make M^ indefinite
        if (h / 2 < min_h) return ended(StepStatus::not_finite);
        halve();
        break;
      case Outcome::not_solved:  // a shorter step is an easier problem; after that the report tells
        if (++unsolved <= 3 && h / 2 >= min_h) {
          halve();
          break;
        }
        [[fallthrough]];
      case Outcome::accepted:
        state = std::move(trial.next);
        state.h_next = h < h_asked ? o.growth * h
                                   : std::max(h_control, o.growth * h);  // only a cut step makes it smaller
        return ended(trial.outcome == Outcome::accepted ? StepStatus::ok : StepStatus::not_solved);
      case Outcome::bound_exceeded:
        estimate.v = trial.v_path;
        if (++enlarged % 4 == 0) halve();
        break;
      case Outcome::meets: {
        std::vector<std::pair<int, int>> all;
        std::ranges::set_union(estimate.meeting, trial.meeting, std::back_inserter(all));
        estimate.meeting = std::move(all);
        break;
      }
      case Outcome::not_certified:
        halve();
        break;
    }
  }
  std::ostringstream text;
  text << "no step of at least " << min_h << " s was accepted: ";
  const std::string wrong = o.certify ? wrong_start(setting.model, state, setting.bounds, setting.pieces, o,
                                                    setting.options.threads)
                                      : "";
  text << (wrong.empty() ? report.reason : "start: " + wrong);
  report.reason = text.str();
  return ended(StepStatus::refused);
}

}  // namespace aussois
