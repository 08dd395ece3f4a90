// SPDX-License-Identifier: Apache-2.0
#include "reduction/extreme_points.hpp"

#include <algorithm>

namespace aussois {
namespace {

int first_extreme(const PlanarPatch& patch, const Vec2& d) {
  const auto far = std::max_element(patch.x.begin(), patch.x.end(),
                                    [&](const Vec2& a, const Vec2& b) { return d.dot(a) < d.dot(b); });
  return int(far - patch.x.begin());
}

}  // namespace

std::vector<int> extreme_points(const PlanarPatch& patch, double tie, bool paper_exact) {
  std::vector<int> result;
  for (const Vec2& d : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)})
    result.push_back(paper_exact ? first_extreme(patch, d)
                                 : extreme_member(patch, d, Vec2(-d.y(), d.x()), tie * patch.extent));
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace aussois
