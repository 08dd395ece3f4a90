// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/projection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace aussois {
namespace {

constexpr int kRounds = 12;

// Contacts and gap functions at the poses, frictionless: J d + gap >= 0 for a displacement d (PRJ-2).
ContactBlocks openings(const StepSetting& setting, const State& at, const ContactSet& contacts) {
  const NormalRule over_step{.law = NormalLaw::gap_over_step, .correction_speed = kInf};
  State resting = at;
  resting.v.setZero();
  const VecX none = VecX::Zero(at.v.size());
  ContactBlocks out{.rows = contact_rows(setting.model, resting, setting.dofs, contacts, none, 1, over_step),
                    .gap = {}};
  GapFunctionRows gaps = gap_rows(setting.model, resting, setting.dofs, none, 1, over_step);
  out.rows.insert(out.rows.end(), gaps.rows.begin(), gaps.rows.end());
  out.gap = std::move(gaps.gap);
  for (ContactRow& row : out.rows) row.w.x() = row.gap;
  return out;
}

}  // namespace

// In the units of the step, d / h and w / h.
OpeningDisplacement opening_displacement(const StepSetting& setting, const SparseMatrix& mass,
                                         std::vector<ContactRow> rows, const SparseMatrix& G, double h) {
  double size = 0;  // [m]
  std::erase_if(rows, [](const ContactRow& row) { return !row.can_open; });
  for (ContactRow& row : rows) {
    row.law = unilateral();
    size = std::hypot(size, row.w.x());
    row.w /= h;
  }
  FreeMotion none;
  none.M = mass;
  none.f = VecX::Zero(setting.dofs.rows);
  std::vector<int> all(rows.size());
  std::iota(all.begin(), all.end(), 0);
  FrictionProblem problem = contact_problem(none, setting.dofs, rows, all);
  problem.G = G;
  problem.b = VecX::Zero(G.cols());
  const SolverOptions& asked = setting.options.solver;
  FrictionSolution found =
      solve(problem, VecX(), {.tolerance = std::min(asked.tolerance, 1e-12), .for_all = asked.for_all});
  if (found.report.residual * size <= kOverlapRounding / 10)  // what is left shows in no gap
    found.report.status = std::min(found.report.status, SolveStatus::at_rounding);
  return {h * found.v, found.report};
}

Projection without_overlap(const StepSetting& setting, const State& plain, const std::vector<StepPair>& pairs,
                           const FreeMotion& free, const SparseMatrix& G, double h) {
  Projection out{.end = plain, .overlap = kInf};
  State tried = plain;
  OpeningDisplacement last;  // that led to `tried`
  VecX total = VecX::Zero(setting.dofs.rows);
  for (int round = 0; round < kRounds; ++round) {
    const ContactSet contacts = contacts_of(setting.model, tried, pairs, setting.options.lmd);
    const ContactBlocks blocks = openings(setting, tried, contacts);
    double overlap = 0;
    for (const ContactRow& row : blocks.rows)
      if (row.can_open) overlap = std::max(overlap, -row.gap);
    if (!(overlap < out.overlap)) break;  // as far as rounding, or the geometry, lets it
    out.overlap = overlap;
    out.end = tried;
    out.solve.status = std::max(out.solve.status, last.report.status);
    out.moved = total.size() > 0 ? total.lpNorm<Eigen::Infinity>() : 0;
    if (overlap <= kOverlapRounding) break;
    for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
      if (!blocks.rows[i].can_open || blocks.rows[i].gap >= -kOverlapRounding) continue;
      if (i < contacts.points.size())
        out.contacts.push_back(key_of(contacts.points[i]));
      else
        out.gaps.push_back(int(i - contacts.points.size()));
    }
    last = opening_displacement(setting, free.mass, blocks.rows, G, h);
    add_counts(last.report, out.solve);
    if (!last.d.allFinite()) break;
    total += last.d;
    tried =
        retract(setting.model, tried, all_velocities(setting.dofs, last.d, VecX::Zero(tried.v.size())), 1);
    if (setting.options.joints.project) {
      const State held = projected_state(setting.model, tried).state;
      tried.g = held.g;
      tried.turns = held.turns;
    }
  }
  std::ranges::sort(out.contacts);
  out.contacts.erase(std::unique(out.contacts.begin(), out.contacts.end()), out.contacts.end());
  std::ranges::sort(out.gaps);
  out.gaps.erase(std::unique(out.gaps.begin(), out.gaps.end()), out.gaps.end());
  return out;
}

}  // namespace aussois
