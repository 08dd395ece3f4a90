// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/landing.hpp"

#include <algorithm>
#include <utility>

#include "integrators/pose/projection.hpp"

namespace aussois {
namespace {

constexpr double kLoad = 1e-6;  // of the impulse now; what bore less in the step before bore rounding

// How fast a closed contact may close again by the turning of its bodies alone: its arms and its normal are
// others after a step (MJ-17) [m/s].
double closing_by_turning(const StepSetting& setting, const State& start, const VecX& v_prescribed,
                          const ContactRow& row, double slip, double h) {
  double out = 0;
  for (const BodyId body : {row.body_a, row.body_b}) {
    const bool free = has_inertia(setting.model.bodies[body]);
    const double spin = angular_part(free ? start.v : v_prescribed, body).norm();
    out += h * spin * (spin * setting.bounds[body].radius + slip);
  }
  return out;
}

}  // namespace

VecX landing_path(const StepSetting& setting, const State& start, const FoundContacts& found,
                  const VecX& v_path, ImpulseStep& step) {
  const VecX v_end = step.solved.solution.v;
  std::vector<ContactRow> opening;
  bool lands = false, closes_on = false;
  const std::vector<RowVector> r = row_impulses(step);
  for (std::size_t i = 0; i < step.rows.size(); ++i) {
    ContactRow& row = step.rows[i];
    if (row.law.kind == LawKind::dry_friction) continue;
    const double ahead = row.gap + found.h * slip_velocity(row, setting.dofs, v_path).x();
    bool landing = ahead < -kOverlapRounding;
    if (landing && !row.slot) {
      const RowVector before = slip_velocity(row, setting.dofs, step.free->v);
      landing = -before.x() >
                closing_by_turning(setting, start, step.v_prescribed, row, before.head<3>().norm(), found.h);
    } else if (landing) {  // of gap functions and stops: none that bore a load
      landing = start.r.size() == 0 || !(start.r[*row.slot] > kLoad * r[i].x());
    }
    opening.push_back(row);
    opening.back().w.x() = landing ? ahead : std::max(0.0, ahead);
    lands |= landing;
    if (!landing || slip_velocity(row, setting.dofs, v_end).x() >= 0) continue;
    row.w.x() = row.moved.x();
    closes_on = true;
  }
  if (!lands) return v_path;
  if (closes_on) {
    keep_status(step);
    solve_rows(setting, start, found, step);
  }
  StageClock clock(Stage::solve, setting.options.profile);
  const bool massless = (step.free->mass.diagonal().array() == 0).any();  // points whose stiffness holds them
  const auto [d, report] = opening_displacement(setting, massless ? step.free->M : step.free->mass,
                                                std::move(opening), step.joints.equations.G, found.h);
  clock.add_to(step.times);
  add_part(report, step.beside);
  return v_path + d / found.h;
}

}  // namespace aussois
