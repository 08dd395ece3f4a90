// SPDX-License-Identifier: Apache-2.0
#include "integrators/d1_minus_linear.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrators/advance_step.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr double kTheta = 0.5;  // joints hold for the mean velocity (MJT-10)

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
  out.joints = joint_system(model, state, dofs, out.v_prescribed, h, kTheta, o.normal, o.joints);
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
    if (const int first = body < 0 ? -1 : dofs.first[std::size_t(body)]; first >= 0)
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

// The rows of a stage: u >= 0 where they are asked, friction of axes within `part` of its limit.
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

}  // namespace

void validate(const D1MinusLinearOptions& options) {
  refuse_anchors(options.step, "d1_minus_linear");
  validate(options.step);
}

D1MinusLinear::D1MinusLinear(const Model& model, const D1MinusLinearOptions& options)
    : setting_(step_setting(model, options.step)) {
  validate(options);
}

StepReport D1MinusLinear::step(State& state, double h_limit) const {
  const Model& model = setting_.model;
  const Layout& dofs = setting_.dofs;
  const auto estimate = [&](const State& from, double h) {
    const Start start = start_of(setting_, from, h);
    return all_velocities(dofs, start.v_free, start.v_prescribed);
  };
  const auto attempt = [&](const State& from, const Estimate& ahead, double h) {
    Found found = find_ahead(setting_, from, ahead, h);
    const Start start = start_of(setting_, from, h);
    ImpulseStep step{.v_prescribed = start.v_prescribed, .joints = start.joints};
    NormalLawOptions gap = setting_.options.normal;
    gap.law = NormalLaw::gap_over_step;
    add_rows(setting_, from, found, gap, step);
    const std::vector<ContactRow> rows = step.rows;
    const double touching = closed_gap(gap, h) / h;
    const std::vector<char> lasting = lasting_contacts(rows, dofs, start, touching);
    FreeMotion free{.M = start.mass, .v = start.v, .v_free = start.v_free, .mass = start.mass};
    free.M.makeCompressed();
    free.gyroscopic_D = free.law_D = SparseMatrix(dofs.rows, dofs.rows);

    const auto solve_stage = [&] {
      step.free = std::make_shared<const FreeMotion>(free);
      solve_rows(setting_, from, found, step);
      keep_status(step);
      for (const int i : step.solved.kept)  // what was asked once is asked in all stages
        if (std::size_t(i) < found.contacts.points.size()) found.selection.kept.push_back(i);
      return row_impulses(step);
    };

    // Forces of the start: predicted velocity, and with it the pose at the end (DML-2), (DML-4)
    step.rows = stage_rows(rows, lasting, 1);
    free.f = start.mass * start.v + h * start.forces.sum();
    step.tolerance_part = 0.5;  // half of it is taken to the next stage, which is half as large
    const std::vector<RowVector> r_1 = solve_stage();
    step.tolerance_part = 1;
    const VecX v_1 = step.solved.solution.v, v_path = (start.v + v_1) / 2;
    const State end = state_after(model, from,
                                  path_velocity(setting_.options.update, model, from,
                                                all_velocities(dofs, v_path, start.v_prescribed), h),
                                  all_velocities(dofs, v_1, start.v_prescribed), h);

    // The mean of both ends: velocity before the impact (DML-4)
    const Forces forces = forces_at(model, end, dofs);
    free.gravity = h / 2 * (start.forces.gravity + forces.gravity);
    free.laws = h / 2 * (start.forces.laws + forces.laws);
    free.gyroscopic = h / 2 * (start.forces.gyroscopic + forces.gyroscopic);
    free.axes = trapezoid(h, start.forces.axes, forces.axes);
    step.rows = stage_rows(rows, lasting, 0.5);
    free.f =
        start.mass * start.v + free.gravity + free.laws + free.gyroscopic + momentum_of(rows, dofs, r_1) / 2;
    step.solved.solution.r /= 2;  // where the solver starts
    const std::vector<RowVector> r_2 = solve_stage();
    const VecX v_2 = step.solved.solution.v;
    step.earlier = r_1;
    for (RowVector& r : step.earlier) r /= 2;

    // Impacts, if anything comes that was not there (DML-5), (DML-6)
    std::vector<char> closed = lasting;
    bool impact = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (lasting[i] || !has_normal(rows[i].law)) continue;
      closed[i] = closes(rows[i], dofs, start.v, v_1, touching);
      impact = impact || (closed[i] && normal_velocity(rows[i], dofs, v_2) < 0);
    }
    if (impact) {
      for (std::size_t i = 0; i < rows.size(); ++i) step.earlier[i] += r_2[i];
      step.lambda_earlier = step.solved.solution.lambda;
      step.rows = stage_rows(rows, closed, 0);
      for (ContactRow& row : step.rows)
        if (has_normal(row.law)) row.w[0] += row.restitution * std::min(normal_velocity(row, dofs, v_2), 0.0);
      free.f = start.mass * v_2;
      if (JointEquations& joints = step.joints.equations; joints.G.cols() > 0)
        joints.b = -(joints.G.transpose() * v_2);
      step.solved.first_row.clear();  // starts from the impulses of the last step again
      solve_stage();
    }
    return go(setting_, from, found, step, {.v_path = v_path, .v_end = step.solved.solution.v});  // (DML-7)
  };
  return advance_step(setting_, state, h_limit, {estimate, attempt});
}

}  // namespace aussois
