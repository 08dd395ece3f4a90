// SPDX-License-Identifier: Apache-2.0
// Parts of a problem that do not feel each other (ISL-1): solved apart, each as if the others were not there.
// Private to nsgs.
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

/// Ordered by their first dof, or block; then blocks that nothing moves, one by one; at the end all that
/// feels no contact. As if there were none of the blocks left out (none if empty).
std::vector<Island> islands(const FrictionProblem& problem, const std::vector<char>& left_out = {});

/// Of every block the first one of its island.
std::vector<int> leaders(const LocalProblem& problem);
/// The islands that `leaders` tells of, without the blocks left out (none if empty).
std::vector<Island> islands(const LocalProblem& problem, const std::vector<int>& leader,
                            const std::vector<char>& left_out = {});

/// Whether the island has all that the problem has.
bool is_whole(const FrictionProblem& problem, const Island& island);
bool is_whole(const LocalProblem& problem, const Island& island);

/// `scratch` is empty at first, and handed from one part to the next.
FrictionProblem part(const FrictionProblem& problem, const Island& island, std::vector<int>& scratch);
LocalProblem part(const LocalProblem& problem, const Island& island, std::vector<int>& scratch);

}  // namespace aussois
