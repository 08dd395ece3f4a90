// SPDX-License-Identifier: Apache-2.0
// Friction and restitution that make roll-outs of some tosses come nearest to what was recorded (TOSS-5), on
// a board where the cube came to rest (TOSS-4).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "examples/studies/toss/toss_kept.hpp"

namespace aussois {

/// Where the board must be for the cube to rest on it as recorded: the median over the tosses of the last
/// height of the centre, less half an edge [m].
double board_of(const std::vector<Toss>& tosses);

struct TossFit {
  double mu = 0, restitution = 0;  // the best so far
  double error = 0;                // its mean over the tosses of position + edge / 2 * rotation [m]
  int points = 0;                  // tried
  std::int64_t steps = 0;          // of all their roll-outs
  int known = 0;                   // points that were read
  RunAudit audit{};                // of all roll-outs
};
/// Compass search from the values of `world`, on a grid of 0.0025 (mu) by 0.0125 (restitution): errors of
/// roll-outs jump where a cube falls on another face, so that derivatives say nothing. It looks around with
/// one step per row, then goes on from there with three, or those of `world` if they are fewer; a point is
/// given up as soon as its sum over the tosses, the worst ones first, exceeds that of the best. The same bits
/// for any number of threads. `seen` hears of every point and stops the search by returning false. Every step
/// is watched as `watch` says, but for files of problems. Each point is kept when it is complete, in
/// fit_STAGE_NUMBER.json.
TossFit fit(const std::vector<Toss>& tosses, const TossWorld& world, int threads,
            const std::function<bool(const TossFit&)>& seen, const TossKeep& keep = {},
            const WatchFlags& watch = {});

}  // namespace aussois
