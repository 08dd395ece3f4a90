// SPDX-License-Identifier: Apache-2.0
// The problem of the kept contacts, grown until it satisfies all contacts that were found (decision record
// 0007).
#pragma once

#include "integrators/pose/joint_rows.hpp"
#include "nsgs/solve.hpp"
#include "reduction/reduce.hpp"

namespace aussois {

struct ReducedSolution {
  std::vector<int> kept{};                           // rows in the problem, ascending
  std::shared_ptr<const FrictionProblem> problem{};  // with joints
  std::vector<int> first_row{};                      // of each kept row in the problem
  VecX start{};                                      // impulses that the last round started with
  FrictionSolution solution{};                       // the work in its report is that of all rounds
};

/// What velocities of two solves of one problem, or one that is to vanish, may be off by per unit of the
/// solver's tolerance, relative to the largest or in m/s, rad/s: a thousand for mass ratios of a million.
inline constexpr double kSolverNoise = 1e3;

/// Adds what another solve took to `sum`: iterations and failures of local methods.
void add_counts(const SolveReport& other, SolveReport& sum);
/// Adds a solve that the step stands on as well: what it took, and its status if that is worse.
void add_part(const SolveReport& part, SolveReport& sum);

/// The first rows are those of `selection`'s contacts, the others are never left out. `warm[i]` are the
/// impulses that row i starts with [N s, N m s]; a contact that was left out re-enters when it closes faster
/// than `allowed_speed[i]` [m/s], the worst of each cluster per round.
ReducedSolution solve_reduced(const FreeMotion& free, const Layout& dofs, const std::vector<ContactRow>& rows,
                              const JointEquations& joints, const Selection& selection,
                              const std::vector<RowVector>& warm, const std::vector<double>& allowed_speed,
                              const SolverOptions& options);

}  // namespace aussois
