// SPDX-License-Identifier: Apache-2.0
// Pairs of balls that meet, by sorting along the axis of largest spread and sweeping.
#pragma once

#include <utility>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct Ball {
  Vec3 centre = Vec3::Zero();  // world [m]
  double radius = 0;           // with everything that inflates it [m]
};

/// Index pairs (i < j), sorted.
std::vector<std::pair<int, int>> broad_phase(const std::vector<Ball>& balls);

}  // namespace aussois
