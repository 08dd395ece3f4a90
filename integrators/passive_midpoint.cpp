// SPDX-License-Identifier: Apache-2.0
#include "integrators/passive_midpoint.hpp"

#include <algorithm>

#include "integrators/advance_step.hpp"

namespace aussois {
namespace {

constexpr double kTheta = 0.5;
constexpr int kRounds = 20;       // of linearisation and passivity together; 2 or 3 are usual
constexpr double kExact = 1e-16;  // of the gyroscopic torque: its error is quadratic in that of the guess

// What (PMI-3), linearised about the mean with `guess`, is off at `v`, relative to the spin.
double gyroscopic_error(const DofMap& dofs, const VecX& before, const VecX& guess, const VecX& v, double h) {
  double worst = 0;
  for (const int row : dofs.first) {
    if (row < 0) continue;
    const double off = (v - guess).segment<3>(row + 3).norm() / 2;
    const double spin = (v + before).segment<3>(row + 3).norm() / 2;
    if (off > 0) worst = std::max(worst, h * off * off / std::max(spin, off));
  }
  return worst;
}

// Velocity of a row without its law.
RowVector plain_velocity(const ContactRow& row, const DofMap& dofs, const VecX& v) {
  return relative_velocity(row, dofs, v) - row.w + row.moved;
}

// Rows that would give energy are stated at the midpoint (PMI-6); how many more that are.
int make_passive(const DofMap& dofs, double tolerance, ImpulseStep& step, std::vector<char>& stated) {
  int count = 0;
  const std::vector<RowVector> r = row_impulses(step);
  for (std::size_t i = 0; i < step.rows.size(); ++i) {
    ContactRow& row = step.rows[i];
    if (stated[i] || !has_normal(row.law) || r[i].isZero(0)) continue;
    const RowVector before = plain_velocity(row, dofs, step.free.v),
                    after = plain_velocity(row, dofs, step.solved.solution.v),
                    without = plain_velocity(row, dofs, step.free.v_free);
    const double noise = tolerance * r[i].norm() * (before.norm() + without.norm());
    if (r[i].dot(before + after) / 2 <= noise) continue;  // (PMI-5)
    const double bias = std::max(row.w[0] - row.moved[0], before[0]);
    row.w.head(row.law.rows) = (row.moved + before).head(row.law.rows);
    row.w[0] = row.moved[0] + bias;
    stated[i] = 1;
    ++count;
  }
  return count;
}

}  // namespace

void validate(const PassiveMidpointOptions& options) {
  refuse_anchors(options.step, "passive_midpoint");
  validate(options.step);
}

PassiveMidpoint::PassiveMidpoint(const Model& model, const PassiveMidpointOptions& options)
    : setting_(step_setting(model, options.step)),
      gyroscopic_(options.gyroscopic),
      passive_(options.passive) {
  validate(options);
}

StepReport PassiveMidpoint::step(State& state, double h_limit) const {
  const Model& model = setting_.model;
  const DofMap& dofs = setting_.dofs;
  const auto estimate = [&](const State& start, double h) {
    return estimate_without_contacts(setting_, start, free_motion(model, start, dofs, h, kTheta), h, kTheta);
  };
  const auto attempt = [&](const State& start, const Estimate& ahead, double h) {
    const Found found = find_ahead(setting_, start, ahead, h);
    const FreeMotion plain = free_motion(model, start, dofs, h, kTheta);  // (MJ-4), (MJ-5)
    VecX guess = plain.v_free;
    ImpulseStep step =
        pose_step(setting_, start, found, with_gyroscopic(model, dofs, h, gyroscopic_, guess, plain), kTheta);
    std::vector<char> stated(step.rows.size(), 0);
    for (int k = 0; k < kRounds; ++k) {
      solve_rows(setting_, start, found, step);
      const VecX& v = step.solved.solution.v;
      if (!v.allFinite()) break;
      const bool off =
          gyroscopic_ == GyroscopicTerm::midpoint && gyroscopic_error(dofs, plain.v, guess, v, h) > kExact;
      const bool gives = passive_ && make_passive(dofs, setting_.options.solver.tolerance, step, stated) > 0;
      if (!off && !gives) break;
      if (off) {
        guess = v;
        step.free = with_gyroscopic(model, dofs, h, gyroscopic_, guess, plain);
      }
    }
    const VecX& v = step.solved.solution.v;
    Attempt out = go(setting_, start, found, step,
                     {.v_path = kTheta * v + (1 - kTheta) * step.free.v, .v_end = v});  // (PMI-4)
    out.report.contacts_made_passive = int(std::count(stated.begin(), stated.end(), 1));
    return out;
  };
  return advance_step(setting_, state, h_limit, {estimate, attempt});
}

}  // namespace aussois
