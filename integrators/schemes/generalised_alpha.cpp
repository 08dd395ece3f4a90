// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/generalised_alpha.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/settings.hpp"
#include "integrators/schemes/advance_step.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr int kNewtonSteps = 20;
constexpr double kSolved = 1e-12;  // change of velocities, relative
constexpr double kGivenUp = 1e-8;  // more than that is no solution

// (GA-2)
struct Weights {
  double m = 0, f = 0, gamma = 1, beta = 0.5;
};
Weights weights(double rho) {
  const double m = (2 * rho - 1) / (rho + 1), f = rho / (rho + 1), gamma = 0.5 + f - m;
  return {m, f, gamma, (gamma + 0.5) * (gamma + 0.5) / 4};
}

// The motion between contacts, rows of the problem.
struct SmoothMotion {
  bool solved = false;
  Weights weights{};
  VecX v_before{}, v_path{}, v{};  // at the start, mean, at the end
  VecX a_before{}, a{};            // accelerations of the recursion
  VecX rate_before{}, rate{};      // accelerations of the equation of motion
  VecX lambda{};                   // [N, N m]
  State end{};
  Forces forces{};  // at the end
  JointSystem joints{};
};

// The accelerations in State::a, rows of the problem.
VecX kept(const Layout& dofs, const State& state, int which) {
  return free_velocities(dofs, state.a.segment(which * state.v.size(), state.v.size()));
}

// (GA-1) to (GA-5), by Newton on the acceleration at the end.
SmoothMotion smooth_motion(const StepSetting& setting, const State& state, const VecX& v_prescribed, double h,
                           double rho) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  const bool fresh = state.a.size() == 0;
  SmoothMotion out{.weights = fresh ? Weights{} : weights(rho)};  // (GA-4)
  const Weights& w = out.weights;
  out.v_before = free_velocities(dofs, state.v);
  out.a_before = fresh ? VecX::Zero(dofs.rows) : kept(dofs, state, 0);
  out.rate_before = fresh ? VecX::Zero(dofs.rows) : kept(dofs, state, 1);
  out.rate = out.rate_before;
  const double share = (1 - w.f) / (1 - w.m), to_v = h * w.gamma * share, to_q = h * h * w.beta * share;
  const auto follow = [&] {
    out.a = share * out.rate + (w.f * out.rate_before - w.m * out.a_before) / (1 - w.m);  // (GA-2)
    out.v = out.v_before + h * ((1 - w.gamma) * out.a_before + w.gamma * out.a);          // (GA-3)
    out.v_path = out.v_before + h * ((0.5 - w.beta) * out.a_before + w.beta * out.a);
    const VecX path = path_velocity(setting.options.update, model, state,
                                    all_velocities(dofs, out.v_path, v_prescribed), h);
    out.end = state_after(model, state, path, all_velocities(dofs, out.v, v_prescribed), h);
  };
  follow();
  double last = kInf;
  for (int k = 0; k < kNewtonSteps && !out.solved; ++k) {
    out.forces = forces_at(model, out.end, dofs);
    out.joints = joint_system_at(model, state, out.end, dofs, v_prescribed, h, setting.normal);
    const SparseMatrix& G = out.joints.equations.G;
    FrictionProblem problem{.M = out.forces.mass + to_v * out.forces.C + to_q * out.forces.K,
                            .H = SparseMatrix(dofs.rows, 0)};
    problem.f = problem.M * out.rate - out.forces.mass * out.rate + out.forces.sum();
    if (G.cols() > 0) {
      problem.G = G;
      problem.b = (G.transpose() * (out.v - to_v * out.rate) + out.joints.equations.b) / to_v;  // (GA-5)
    }
    const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
    if (!inverse) {
      out.v.setConstant(std::nan(""));  // ends as not_finite in this very step
      return out;
    }
    const JointedMotion next = motion(problem, *inverse, VecX());
    const double size = std::max({out.v.lpNorm<Eigen::Infinity>(), to_v * next.v.lpNorm<Eigen::Infinity>(),
                                  std::numeric_limits<double>::min()});
    const double change = to_v * (next.v - out.rate).lpNorm<Eigen::Infinity>() / size;
    out.rate = next.v;
    out.lambda = next.lambda;
    follow();
    out.solved =
        change <= kSolved || (change <= kGivenUp && change >= last / 2);  // as far as rounding lets it
    last = change;
  }
  return out;
}

// Rows of the coordinates go to `coordinates`, those of the bodies to `bodies`.
void split(const Layout& dofs, const VecX& from, VecX& bodies, VecX& coordinates) {
  bodies.head(dofs.coordinates) += from.head(dofs.coordinates);
  coordinates.tail(dofs.rows - dofs.coordinates) += from.tail(dofs.rows - dofs.coordinates);
}

// Impulses along the columns of G that come nearest to a momentum.
VecX nearest_impulses(const SparseMatrix& M, const SparseMatrix& G, const VecX& momentum) {
  const FrictionProblem problem{
      .M = M, .H = SparseMatrix(M.rows(), 0), .f = momentum, .G = G, .b = VecX::Zero(G.cols())};
  const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
  return inverse ? VecX(-motion(problem, *inverse, VecX()).lambda) : problem.b;
}

// What the problem of velocities starts from: impulses between contacts by their origin (GA-10), and the part
// of joints by columns.
struct BetweenContacts {
  FreeMotion free{};
  std::vector<JointImpulses> joints{};
};
BetweenContacts between_contacts(const StepSetting& setting, const State& state, const SmoothMotion& smooth,
                                 double h) {
  const Layout& dofs = setting.dofs;
  const bool fresh = state.a.size() == 0;
  const SparseMatrix& M = smooth.forces.mass;
  const Forces before = fresh ? smooth.forces : forces_at(setting.model, state, dofs);
  const VecX& rate_before = fresh ? smooth.rate : smooth.rate_before;
  const Weights& w = smooth.weights;
  BetweenContacts out{
      .free = {.M = M, .f = M * smooth.v, .v = smooth.v_before, .v_free = smooth.v, .mass = M}};
  FreeMotion& free = out.free;
  free.M.makeCompressed();
  free.gyroscopic_D = free.law_D = SparseMatrix(dofs.rows, dofs.rows);
  free.gravity = h / 2 * (before.gravity + smooth.forces.gravity);
  free.laws = h / 2 * (before.laws + smooth.forces.laws);
  free.axes = trapezoidal_impulses(h, before.axes, smooth.forces.axes);
  free.gyroscopic = h / 2 * (before.gyroscopic + smooth.forces.gyroscopic);
  const VecX mean = (rate_before + smooth.rate) / 2;
  free.numerical = h * (M * ((1 - w.gamma) * smooth.a_before + w.gamma * smooth.a - mean));
  VecX other = h * (M * mean) - (free.gravity + free.laws + free.gyroscopic);
  if (!setting.model.joints.empty()) {
    const SparseMatrix& G = smooth.joints.equations.G;
    JointImpulses end{smooth.joints.columns, h / 2 * smooth.lambda}, start = end;
    VecX given = 2 * (G * end.lambda);
    if (!fresh) {
      JointConstraints there = joint_constraints(setting.model, state, dofs);
      const VecX left = h / 2 * (before.mass * rate_before - before.sum());
      start = {std::move(there.columns), nearest_impulses(before.mass, there.G, left)};
      given = G * end.lambda + there.G * start.lambda;
    }
    other -= given;
    free.joints = given - h * (G * smooth.lambda);  // go counts that of the end
    out.joints = {std::move(start), std::move(end)};
  }
  split(dofs, other, free.numerical, free.gyroscopic);
  return out;
}

// Momentum of the impulses that no gap gives: friction, dry friction and limited motors of axes.
VecX tangential_momentum(const ImpulseStep& step, const Layout& dofs) {
  std::vector<RowVector> r = row_impulses(step);
  for (std::size_t i = 0; i < r.size(); ++i)
    if (has_normal(step.rows[i].law)) r[i][0] = 0;
  return momentum_of(step.rows, dofs, r);
}

// The problem of the mean velocity: joints hold at the end, gaps do not close, no friction (GA-6).
ImpulseStep position_problem(const StepSetting& setting, const State& state, const FoundContacts& found,
                             const SmoothMotion& smooth, const ImpulseStep& velocities) {
  ImpulseStep out{
      .free = velocities.free, .v_prescribed = velocities.v_prescribed, .joints = velocities.joints};
  NormalRule normal = setting.normal;
  normal.law = NormalLaw::gap_over_step;
  out.joints =
      joint_system_at(setting.model, state, smooth.end, setting.dofs, out.v_prescribed, found.h, normal);
  add_rows(setting, state, found, normal, out);
  for (ContactRow& row : out.rows) {
    row.active = has_normal(row.law);
    if (row.active) row.law = unilateral();
  }
  JointEquations& joints = out.joints.equations;
  if (joints.G.cols() > 0) joints.b = out.joints.off / found.h - joints.G.transpose() * smooth.v_path;
  return out;
}

}  // namespace

void describe(SettingVisitor& visit, GeneralisedAlphaOptions& o) {
  visit.begin("GeneralisedAlphaOptions");
  visit.number({.name = "spectral_radius",
                .what = "spectral radius of infinitely stiff motions; 1: no damping",
                .unit = "-",
                .range = {0, 1},
                .flag = "--spectral-radius",
                .label = "rho %",
                .in_every_label = true},
               o.spectral_radius);
}

void validate(const GeneralisedAlphaOptions& options) {
  check_ranges(options);
}

GeneralisedAlpha::GeneralisedAlpha(const Model& model, const StepOptions& step,
                                   const GeneralisedAlphaOptions& own)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, step))), own_(own) {
  validate(own);
  refuse_unread(step, unread(), "generalised_alpha");
}

namespace {

// Gaps that end closed take part in the impact (GA-7). An impulse that a sweep has left at a gap that ends
// open does not count.
void choose_impacts(const StepSetting& setting, const ImpulseStep& mean, double h, double touching,
                    ImpulseStep& step) {
  const std::vector<RowVector> push = row_impulses(mean);
  const VecX& v_mean = mean.solved.solution.v;
  for (std::size_t i = 0; i < step.rows.size(); ++i) {
    if (!has_normal(step.rows[i].law)) continue;
    const double u = relative_velocity(mean.rows[i], setting.dofs, v_mean)[0];
    const double noise = kSolverNoise * setting.options.solver.tolerance *
                         largest_velocity(mean.rows[i], setting.dofs, v_mean);
    step.rows[i].active = h * u <= touching || (push[i][0] > 0 && u <= noise);
  }
}

Trial attempt(const StepSetting& setting, const State& start, const Estimate& ahead, double h,
              const SmoothMotion& smooth) {
  const Layout& dofs = setting.dofs;
  FoundContacts found = find_ahead(setting, start, ahead, h);
  BetweenContacts between = between_contacts(setting, start, smooth, h);
  ImpulseStep step{.free = std::make_shared<const FreeMotion>(std::move(between.free)),
                   .v_prescribed = prescribed_velocity(setting.model, start, h),
                   .between = std::move(between.joints),
                   .lambda_earlier = h * smooth.lambda};
  NormalRule impact = setting.normal;
  impact.law = NormalLaw::moreau;
  step.joints = joint_system_at(setting.model, start, smooth.end, dofs, step.v_prescribed, h, impact);
  add_rows(setting, start, found, impact, step);

  ImpulseStep mean = position_problem(setting, start, found, smooth, step);
  const VecX momentum = step.free->mass * smooth.v_path;
  const auto solve_mean = [&](const VecX& f) {
    FreeMotion free = *step.free;
    free.f = f;
    mean.free = std::make_shared<const FreeMotion>(free);
    solve_rows(setting, start, found, mean);
  };
  solve_mean(momentum);
  choose_impacts(setting, mean, h, closed_gap(impact, h), step);
  solve_rows(setting, start, found, step);

  // Friction displaces as a constant force does (GA-8)
  const VecX friction = tangential_momentum(step, dofs);
  if (!friction.isZero(0)) {
    keep_status(mean);
    solve_mean(momentum + friction / 2);
  }
  add_part(mean.solved.solution.report, mean.beside);
  add_part(mean.beside, step.beside);
  add(mean.times, step.times);
  if (!smooth.solved) step.beside.status = std::max(step.beside.status, SolveStatus::max_iterations);
  const VecX none = VecX::Zero(start.v.size());
  Trial trial{
      .move = {.v_path = mean.solved.solution.v, .v_end = step.solved.solution.v, .about = 1},  // (GA-9)
      .a = VecX(2 * start.v.size())};
  trial.found = std::move(found);
  trial.impulses = std::move(step);
  trial.a << all_velocities(dofs, smooth.a, none), all_velocities(dofs, smooth.rate, none);
  return trial;
}

}  // namespace

StepReport GeneralisedAlpha::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  const auto smooth_from = [&](const State& start, double h) {
    return smooth_motion(setting, start, prescribed_velocity(setting.model, start, h), h,
                         own_.spectral_radius);
  };
  return advance_step(setting, state, h_limit,
                      {[&](const State& start, double h) {
                         return all_velocities(setting.dofs, smooth_from(start, h).v,
                                               prescribed_velocity(setting.model, start, h));
                       },
                       [&](const State& start, const Estimate& ahead, double h) {
                         return attempt(setting, start, ahead, h, smooth_from(start, h));
                       }});
}

}  // namespace aussois
