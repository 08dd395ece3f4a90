// SPDX-License-Identifier: Apache-2.0
#include "reduction/direction_set.hpp"

#include <algorithm>
#include <cmath>

namespace aussois {

std::vector<int> direction_set(const PlanarPatch& patch, int directions, double tie) {
  std::vector<int> result;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * kPi * k / directions;
    const Vec2 d(std::cos(angle), std::sin(angle));
    result.push_back(extreme_member(patch, d, Vec2(-d.y(), d.x()), tie * patch.extent));
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace aussois
