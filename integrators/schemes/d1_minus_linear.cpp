// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/d1_minus_linear.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/settings.hpp"
#include "integrators/schemes/advance_step.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr double kJointTheta = 0.5;  // joints hold for the mean velocity (MJT-10)

/// What all stages of a step share.
struct Start {
  VecX v{}, v_prescribed{};  // v: rows of the problem
  SparseMatrix mass{};       // at the middle
  Forces forces{};           // at the start
  JointSystem joints{};
  VecX v_free{};  // after an explicit step without contacts
};

Start start_of(const StepSetting& setting, const State& state, double h) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  const StepOptions& o = setting.options;
  Start out{.v = free_velocities(dofs, state.v), .v_prescribed = prescribed_velocity(model, state, h)};
  out.forces = forces_at(model, state, dofs);
  out.mass = model.coordinates.empty()
                 ? out.forces.mass
                 : forces_at(model, state_after(model, state, state.v, state.v, h / 2), dofs).mass;
  out.joints = joint_system(model, state, dofs, out.v_prescribed, h, kJointTheta, setting.normal, o.joints);
  const FrictionProblem problem{.M = out.mass,
                                .H = SparseMatrix(dofs.rows, 0),
                                .f = out.mass * out.v + h * out.forces.sum(),
                                .G = out.joints.equations.G,
                                .b = out.joints.equations.b};
  if (const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G))
    out.v_free = free_velocity(problem, *inverse);
  else
    out.v_free = VecX::Constant(dofs.rows, std::nan(""));  // ends as not_finite in this very step
  return out;
}

double normal_velocity(const ContactRow& row, const Layout& dofs, const VecX& v) {
  return relative_velocity(row, dofs, v)[0] - row.w[0] + row.moved[0];
}

// What velocities `dv` change in the normal velocity, by the row's bodies and coordinates each on its own.
double normal_changes(const ContactRow& row, const Layout& dofs, const VecX& dv) {
  double sum = 0;
  for (const auto& [body, J] : {std::pair(row.body_a, &row.J_a), std::pair(row.body_b, &row.J_b)})
    if (const int first = first_row(dofs, body); first >= 0)
      sum += std::abs(J->row(0).dot(dv.segment<6>(first)));
  for (const Triplet& e : row.others)
    if (e.row() == 0) sum += std::abs(e.value() * dv[e.col()]);
  return sum;
}

// Is the gap closed at the end of a step with the velocities v and v_end at its ends? `row`: biased by the
// gap over the step; `touching`: of (MJ-6), as a velocity.
bool closes(const ContactRow& row, const Layout& dofs, const VecX& v, const VecX& v_end, double touching) {
  return row.w[0] - row.moved[0] + (normal_velocity(row, dofs, v) + normal_velocity(row, dofs, v_end)) / 2 <=
         touching;
}

std::vector<char> lasting_contacts(const std::vector<ContactRow>& rows, const Layout& dofs,
                                   const Start& start, double touching) {
  std::vector<char> out;
  for (const ContactRow& row : rows)
    out.push_back(has_normal(row.law) && closes(row, dofs, start.v, start.v_free, touching) &&
                  normal_velocity(row, dofs, start.v) >=
                      -normal_changes(row, dofs, start.v_free - start.v) - touching);  // (DML-3)
  return out;
}

// The rows of a stage: u >= 0 for those in `asked`, friction of axes within `part` of its limit.
std::vector<ContactRow> stage_rows(const std::vector<ContactRow>& rows, const std::vector<char>& asked,
                                   double part) {
  std::vector<ContactRow> out = rows;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (has_normal(out[i].law)) {
      out[i].active = asked[i];
      out[i].w[0] = out[i].moved[0];
    } else {
      out[i].law.limit *= part;
    }
  }
  return out;
}

// A step between its stages.
struct StagedStep {
  const StepSetting& setting;
  const State& from;
  const Start& start;
  double h = 0, touching = 0;  // touching: of (MJ-6), as a velocity
  FoundContacts found{};
  ImpulseStep step{};
  std::vector<ContactRow> rows{};  // before any stage
  std::vector<char> lasting{};     // contacts
  FreeMotion free{};
};

StagedStep staged_step(const StepSetting& setting, const State& from, const Start& start, FoundContacts found,
                       double h) {
  NormalRule gap = setting.normal;
  gap.law = NormalLaw::gap_over_step;
  StagedStep out{setting, from, start, h, closed_gap(gap, h) / h, std::move(found)};
  out.step.v_prescribed = start.v_prescribed;
  out.step.joints = start.joints;
  add_rows(setting, from, out.found, gap, out.step);
  out.rows = out.step.rows;
  out.lasting = lasting_contacts(out.rows, setting.dofs, start, out.touching);
  out.free.M = out.free.mass = start.mass;
  out.free.v = start.v;
  out.free.v_free = start.v_free;
  out.free.M.makeCompressed();
  out.free.gyroscopic_D = out.free.law_D = SparseMatrix(setting.dofs.rows, setting.dofs.rows);
  return out;
}

std::vector<RowVector> solve_stage(StagedStep& s) {
  s.step.free = std::make_shared<const FreeMotion>(s.free);
  solve_rows(s.setting, s.from, s.found, s.step);
  keep_status(s.step);
  for (const int i : s.step.solved.kept)  // a row kept once is in all stages
    if (std::size_t(i) < s.found.contacts.points.size()) s.found.selection.kept.push_back(i);
  return row_impulses(s.step);
}

// Forces of the start: predicted velocity, and with it the pose at the end (DML-2), (DML-4).
std::vector<RowVector> predict(StagedStep& s) {
  s.step.rows = stage_rows(s.rows, s.lasting, 1);
  s.free.f = s.start.mass * s.start.v + s.h * s.start.forces.sum();
  s.step.tolerance_part = 0.5;  // half of it is taken to the next stage, which is half as large
  std::vector<RowVector> r = solve_stage(s);
  s.step.tolerance_part = 1;
  return r;
}

// The mean of both ends: velocity before the impact (DML-4).
std::vector<RowVector> correct(StagedStep& s, const State& end, const std::vector<RowVector>& predicted) {
  const Forces &before = s.start.forces, after = forces_at(s.setting.model, end, s.setting.dofs);
  s.free.gravity = s.h / 2 * (before.gravity + after.gravity);
  s.free.laws = s.h / 2 * (before.laws + after.laws);
  s.free.gyroscopic = s.h / 2 * (before.gyroscopic + after.gyroscopic);
  s.free.axes = trapezoidal_impulses(s.h, before.axes, after.axes);
  s.step.rows = stage_rows(s.rows, s.lasting, 0.5);
  s.free.f = s.start.mass * s.start.v + s.free.gravity + s.free.laws + s.free.gyroscopic +
             momentum_of(s.rows, s.setting.dofs, predicted) / 2;
  s.step.solved.solution.r /= 2;  // where the solver starts
  std::vector<RowVector> r = solve_stage(s);
  s.step.earlier = predicted;
  for (RowVector& earlier : s.step.earlier) earlier /= 2;
  return r;
}

// Impacts, if anything comes that was not there (DML-5), (DML-6); `v_1` was predicted.
void strike(StagedStep& s, const VecX& v_1, const std::vector<RowVector>& corrected) {
  const Layout& dofs = s.setting.dofs;
  const VecX v_2 = s.step.solved.solution.v;
  std::vector<char> closed = s.lasting;
  bool impact = false;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    if (s.lasting[i] || !has_normal(s.rows[i].law)) continue;
    closed[i] = closes(s.rows[i], dofs, s.start.v, v_1, s.touching);
    impact = impact || (closed[i] && normal_velocity(s.rows[i], dofs, v_2) < 0);
  }
  if (!impact) return;
  for (std::size_t i = 0; i < s.rows.size(); ++i) s.step.earlier[i] += corrected[i];
  s.step.lambda_earlier = s.step.solved.solution.lambda;
  s.step.rows = stage_rows(s.rows, closed, 0);
  for (ContactRow& row : s.step.rows)
    if (has_normal(row.law)) row.w[0] += row.restitution * std::min(normal_velocity(row, dofs, v_2), 0.0);
  s.free.f = s.start.mass * v_2;
  if (JointEquations& joints = s.step.joints.equations; joints.G.cols() > 0)
    joints.b = -(joints.G.transpose() * v_2);
  s.step.solved.first_row.clear();  // starts from the impulses of the last step again
  solve_stage(s);
}

Trial attempt(const StepSetting& setting, const State& from, const Estimate& ahead, double h) {
  const Start start = start_of(setting, from, h);
  StagedStep s = staged_step(setting, from, start, find_ahead(setting, from, ahead, h), h);
  const std::vector<RowVector> predicted = predict(s);
  const VecX v_1 = s.step.solved.solution.v, v_path = (start.v + v_1) / 2;
  const VecX path = path_velocity(setting.options.update, setting.model, from,
                                  all_velocities(setting.dofs, v_path, start.v_prescribed), h);
  const State end =
      state_after(setting.model, from, path, all_velocities(setting.dofs, v_1, start.v_prescribed), h);
  const std::vector<RowVector> corrected = correct(s, end, predicted);
  strike(s, v_1, corrected);
  Trial trial{.move = {.v_path = v_path, .v_end = s.step.solved.solution.v}};  // (DML-7)
  trial.found = std::move(s.found);
  trial.impulses = std::move(s.step);
  return trial;
}

}  // namespace

D1MinusLinear::D1MinusLinear(const Model& model, const StepOptions& step)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, step))) {
  refuse_unread(step, unread(), "d1_minus_linear");
}

StepReport D1MinusLinear::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  return advance_step(
      setting, state, h_limit,
      {[&](const State& from, double h) {
         const Start start = start_of(setting, from, h);
         return all_velocities(setting.dofs, start.v_free, start.v_prescribed);
       },
       [&](const State& from, const Estimate& ahead, double h) { return attempt(setting, from, ahead, h); }});
}

}  // namespace aussois
