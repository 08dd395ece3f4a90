// SPDX-License-Identifier: Apache-2.0
// Splits a problem into parts that do not affect each other (ISL-1); each is solved as if the others did not
// exist. Private to nsgs.
#pragma once

#include "nsgs/friction_problem.hpp"

namespace aussois {

/// Indices into the problem, all ascending.
struct Island {
  std::vector<int> blocks{};
  std::vector<int> rows{};    // of these blocks
  std::vector<int> dofs{};    // of M; empty in a local problem
  std::vector<int> joints{};  // columns of G
};

/// The islands in the order of their first dof, then the blocks that nothing moves, one by one, and at the
/// end everything without contact. Blocks marked in `left_out` (empty: none) count as absent.
std::vector<Island> islands(const FrictionProblem& problem, const std::vector<char>& left_out = {});

/// For every block, the first block of its island.
std::vector<int> leaders(const LocalProblem& problem);
/// The islands by leaders(), in the order of their first block, without the blocks marked in `left_out`
/// (empty: none).
std::vector<Island> islands(const LocalProblem& problem, const std::vector<int>& leader,
                            const std::vector<char>& left_out = {});

/// Whether the island is the whole problem.
bool is_whole(const FrictionProblem& problem, const Island& island);
bool is_whole(const LocalProblem& problem, const Island& island);

/// The problem of one island. `scratch` is empty at first and passed on from one call to the next.
FrictionProblem island_problem(const FrictionProblem& problem, const Island& island,
                               std::vector<int>& scratch);
LocalProblem island_problem(const LocalProblem& problem, const Island& island, std::vector<int>& scratch);

}  // namespace aussois
