// SPDX-License-Identifier: Apache-2.0
// Friction and restitution that make roll-outs of some tosses come nearest to what was recorded (TOSS-5), on
// a board where the cube came to rest (TOSS-4).
#pragma once

#include <functional>
#include <vector>

#include "examples/toss/toss_rollout.hpp"

namespace aussois {

/// Where the board must be for the cube to rest on it as recorded: the median over the tosses of the last
/// height of the centre, less half an edge [m].
double board_of(const std::vector<Toss>& tosses);

struct TossFit {
  double mu = 0, restitution = 0;
  double error = 0;     // mean over the tosses of position + edge / 2 * rotation [m]
  int evaluations = 0;  // of all tosses
};
/// Compass search from the values of `world`, on a grid of 0.0025 (mu) by 0.0125 (restitution): errors of
/// roll-outs jump where a cube falls on another face, so that derivatives say nothing. `seen` hears of every
/// point and stops the search by returning false.
TossFit fit(const std::vector<Toss>& tosses, const TossWorld& world, int threads,
            const std::function<bool(const TossFit&)>& seen);

}  // namespace aussois
