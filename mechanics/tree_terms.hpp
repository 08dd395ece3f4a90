// SPDX-License-Identifier: Apache-2.0
// Mass and forces of the bodies that a tree carries, along its coordinates and its base (TREE-3) to (TREE-6).
#pragma once

#include <vector>

#include "mechanics/state.hpp"

namespace aussois {

/// In the order of `velocity`. The mass of the base itself is not among them.
struct TreeTerms {
  std::vector<int> velocity{};  // entries of State::v, ascending: six of a dynamic base, then the coordinates
  MatX mass{};                  // [kg, kg m, kg m^2]
  VecX gravity{}, gyroscopic{};  // [N, N m]; gyroscopic: Coriolis forces too
  MatX C{};                      // -d gyroscopic / dv
  Momentum turning{};            // rate of the links' momentum while no speed changes [N, N m]
};
/// At the poses of `state` and its velocities; carried bodies are where its coordinates put them.
TreeTerms tree_terms(const Model& model, BlockId block, const State& state);
/// A matrix of the terms, in the rows of the problem.
SparseMatrix tree_matrix(const TreeTerms& terms, const MatX& matrix, const Layout& dofs);

/// Adds the forces times `scale` to vectors of the rows of the problem.
void add_tree_forces(const TreeTerms& terms, double scale, const Layout& dofs, VecX& gravity,
                     VecX& gyroscopic);

/// Moves the forces on carried bodies, and their derivatives, to what carries them, at the poses `g`.
void carry_forces(const Model& model, const PerBody<SE3>& g, GeneralisedForce& force);

}  // namespace aussois
