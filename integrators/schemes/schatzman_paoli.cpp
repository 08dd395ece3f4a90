// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/schatzman_paoli.hpp"

#include <algorithm>

#include "geometry/settings.hpp"
#include "integrators/schemes/advance_step.hpp"

namespace aussois {
namespace {

// From the middle of the last path to the middle of the next one (SP-2); a first step has no last path.
FreeMotion kicked_motion(const StepSetting& setting, const State& state, double h, double theta) {
  const double time = (h + state.h) / 2;
  FreeMotion out = free_motion(setting.model, state, setting.dofs, time, theta);
  if (theta < 0.5)  // gyroscopic terms have no explicit form that keeps a top spinning
    out.gyroscopic_D = free_motion(setting.model, state, setting.dofs, time, 0.5).gyroscopic_D;
  sum_up(out);
  return out;
}

// (q_{k+1} + e q_{k-1}) / (1 + e) stays open, by the velocities of both paths (SP-4). A contact that acted in
// the last step finishes what it began, with the length that it began with (SP-5).
double position_bias(const ContactRow& row, double u_before, bool acted, double h, double h_before,
                     double correction_speed) {
  const double e = row.restitution;
  if (e == 0) return std::max(row.gap / h, -correction_speed);
  return (1 + e) * row.gap / (acted ? h_before : h) - e * u_before;
}

// Biases of contacts, gap functions and stops; friction and limited motors of axes act as long as forces do.
void set_position_laws(const StepSetting& setting, const State& state, const FoundContacts& found,
                       std::vector<ContactRow>& rows) {
  const VecX v = free_velocities(setting.dofs, state.v);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ContactRow& row = rows[i];
    if (!has_normal(row.law)) {
      row.law.limit *= (1 + state.h / found.h) / 2;  // (SP-2)
      continue;
    }
    const bool acted = row.slot ? state.r.size() > 0 && state.r[*row.slot] > 0
                                : found.warm.impulse[i].dot(row.frame.col(0)) > 0;
    row.w.x() = row.moved.x() + position_bias(row, slip_velocity(row, setting.dofs, v).x(), acted, found.h,
                                              state.h, setting.normal.correction_speed);
  }
}

}  // namespace

void describe(SettingVisitor& visit, SchatzmanPaoliOptions& o) {
  visit.begin("SchatzmanPaoliOptions");
  visit.number({.name = "force_theta",
                .what = "point of the step at which force laws are evaluated; 0: start, 1: end",
                .unit = "-",
                .range = {0, 1},
                .flag = "--force-theta",
                .label = "force theta %"},
               o.force_theta);
}

void validate(const SchatzmanPaoliOptions& options) {
  check_ranges(options);
}

SchatzmanPaoli::SchatzmanPaoli(const Model& model, const StepOptions& step, const SchatzmanPaoliOptions& own)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, step, NormalLaw::gap_over_step))),
      own_(own) {
  validate(own);
  refuse_unread(step, unread(), "schatzman_paoli");
}

StepReport SchatzmanPaoli::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  const auto estimate = [&](const State& start, double h) {
    return estimate_without_contacts(setting, start, kicked_motion(setting, start, h, own_.force_theta), h,
                                     1);
  };
  const auto attempt = [&](const State& start, const Estimate& ahead, double h) {
    Trial trial{.found = find_ahead(setting, start, ahead, h)};
    ImpulseStep& step = trial.impulses;
    step =
        pose_step(setting, start, trial.found,
                  std::make_shared<const FreeMotion>(kicked_motion(setting, start, h, own_.force_theta)), 1);
    set_position_laws(setting, start, trial.found, step.rows);
    solve_rows(setting, start, trial.found, step);
    trial.move = {.v_path = step.solved.solution.v,
                  .v_end = step.solved.solution.v,
                  .end = {},
                  .goes_on = setting.options.advancement.growth * h,  // the longest that may come (CA-17)
                  .lasts = (1 + start.h / h) / 2,
                  .about = (1 - start.h / h) / 4};  // (SP-3)
    return trial;
  };
  return advance_step(setting, state, h_limit, {estimate, attempt});
}

}  // namespace aussois
