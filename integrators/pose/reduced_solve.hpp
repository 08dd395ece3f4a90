// SPDX-License-Identifier: Apache-2.0
// Solves the problem of the kept contacts, growing it until all contacts that were found are satisfied
// (decision record 0007).
#pragma once

#include "integrators/pose/joint_rows.hpp"
#include "integrators/pose/stage_clock.hpp"
#include "nsgs/solve.hpp"
#include "reduction/reduce.hpp"

namespace aussois {

struct ReducedSolution {
  std::vector<int> kept{};                           // rows in the problem, ascending
  std::shared_ptr<const FrictionProblem> problem{};  // with joints
  std::vector<int> first_row{};                      // of each kept row in the problem
  VecX start{};                                      // impulses that the last round started from
  FrictionSolution solution{};                       // the work in its report is that of all rounds
};

/// Error to expect per unit of the solver's tolerance, in the difference between the velocities of two solves
/// of one problem or in a velocity that should vanish, relative to the largest velocity or in m/s, rad/s. A
/// thousand is meant for mass ratios of a million.
inline constexpr double kSolverNoise = 1e3;

/// Adds the effort of another solve to `sum`: iterations and failures of local methods.
void add_counts(const SolveReport& other, SolveReport& sum);
/// Adds a solve that the step depends on as well: its effort, and its status if that is worse.
void add_part(const SolveReport& part, SolveReport& sum);

/// The first rows are those of `selection`'s contacts; the others are never left out. `warm[i]` are the
/// impulses that row i starts from [N s, N m s]. A contact that was left out re-enters when it closes faster
/// than `allowed_speed[i]` [m/s]; each round adds the worst contact of each cluster. The clock is in the
/// stage `solve`, and is so again afterwards.
ReducedSolution solve_reduced(const FreeMotion& free, const Layout& dofs, const std::vector<ContactRow>& rows,
                              const JointEquations& joints, const Selection& selection,
                              const std::vector<RowVector>& warm, const std::vector<double>& allowed_speed,
                              const SolverOptions& options, StageClock& clock);

}  // namespace aussois
