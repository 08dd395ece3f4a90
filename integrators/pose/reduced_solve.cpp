// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/reduced_solve.hpp"

#include <algorithm>

namespace aussois {
namespace {

bool takes_part(const ContactRow& row) {
  return row.active && row.can_open;
}

// Of each cluster the row that is left out and closes most beyond what is allowed; none: empty.
std::vector<int> rows_to_add(const std::vector<ContactRow>& rows, const std::vector<char>& in,
                             const Selection& selection, const Layout& dofs, const VecX& v,
                             const std::vector<double>& allowed_speed) {
  std::vector<int> worst(std::size_t(selection.cluster_count), -1);
  std::vector<double> excess(worst.size(), 0);
  for (std::size_t i = 0; i < selection.cluster.size(); ++i) {
    if (in[i] || !takes_part(rows[i])) continue;
    const auto cluster = std::size_t(selection.cluster[i]);
    const double closing = -relative_velocity(rows[i], dofs, v).x() - allowed_speed[i];
    if (closing > excess[cluster]) excess[cluster] = closing, worst[cluster] = int(i);
  }
  std::erase(worst, -1);
  return worst;
}

}  // namespace

void add_counts(const SolveReport& other, SolveReport& sum) {
  sum.iterations += other.iterations;
  sum.newton_iterations += other.newton_iterations;
  sum.local_failures += other.local_failures;
  sum.local_fail_safes += other.local_fail_safes;
}

void add_part(const SolveReport& part, SolveReport& sum) {
  add_counts(part, sum);
  sum.status = std::max(sum.status, part.status);
}

ReducedSolution solve_reduced(const FreeMotion& free, const Layout& dofs, const std::vector<ContactRow>& rows,
                              const JointEquations& joints, const Selection& selection,
                              const std::vector<RowVector>& warm, const std::vector<double>& allowed_speed,
                              const SolverOptions& options, StageClock& clock) {
  ReducedSolution out;
  SolveReport rounds;
  std::vector<char> in(rows.size(), 0);
  for (int i : selection.kept) in[i] = takes_part(rows[i]);
  for (std::size_t i = selection.cluster.size(); i < rows.size(); ++i) in[i] = takes_part(rows[i]);
  std::vector<RowVector> r = warm;
  for (;;) {
    clock.enter(Stage::assembly);
    out.kept.clear();
    for (int i = 0; i < int(rows.size()); ++i)
      if (in[i]) out.kept.push_back(i);
    const std::shared_ptr<FrictionProblem> problem(
        new FrictionProblem(contact_problem(free, dofs, rows, out.kept)));  // in place, as of SharedMotion
    problem->G = joints.G;
    problem->b = joints.b;
    out.problem = problem;
    out.first_row = first_rows(problem->laws);
    out.start.resize(out.first_row.back());
    for (std::size_t k = 0; k < out.kept.size(); ++k) {
      const int count = problem->laws[k].rows;
      out.start.segment(out.first_row[k], count) = r[out.kept[k]].head(count);
    }
    clock.enter(Stage::solve);
    out.solution = free.inverse ? solve(*problem, {*free.inverse, free.v_free}, out.start, options)
                                : solve(*problem, out.start, options);
    add_counts(rounds, out.solution.report);
    rounds = out.solution.report;
    if (!out.solution.v.allFinite()) break;
    for (std::size_t k = 0; k < out.kept.size(); ++k) {
      const int count = problem->laws[k].rows;
      r[out.kept[k]].head(count) = out.solution.r.segment(out.first_row[k], count);
    }
    const std::vector<int> more = rows_to_add(rows, in, selection, dofs, out.solution.v, allowed_speed);
    if (more.empty()) break;
    for (int i : more) in[i] = 1;
  }
  return out;
}

}  // namespace aussois
