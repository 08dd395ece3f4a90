// SPDX-License-Identifier: Apache-2.0
// Problems of any laws whose solution is known because the problem was made for it.
#pragma once

#include "nsgs/friction_problem.hpp"
#include "tests/support/random.hpp"

namespace aussois {

struct Planted {
  FrictionProblem problem{};
  VecX u{}, r{};
};

/// Impulses and velocities that obey `laws` by construction: of a third of the blocks open, sticking,
/// slipping. M consists of random 3 x 3 blocks for `velocities` velocities (a multiple of 3), slightly
/// unsymmetric with `gyroscopic` > 0; H is random; w makes (u, r) a solution. More rows than velocities:
/// hyperstatic.
Planted planted(Random& random, const std::vector<Law>& laws, int velocities, double gyroscopic = 0);

/// Of the kinds in turn: coulomb, rolling, contensou, unilateral, dry friction, 2D, bilateral.
std::vector<Law> random_laws(Random& random, int count);

}  // namespace aussois
