// SPDX-License-Identifier: Apache-2.0
// A selection that can be made to change.
#pragma once

#include <algorithm>
#include <cmath>

#include "reduction/selection.hpp"

namespace aussois {

/// Every other contact of a cluster of eight by angle about its middle, which half depends on `odd`; four are
/// kept.
inline ContactSelector every_other(bool odd) {
  return [odd](const ReductionInput& input, const Clusters& clusters) {
    std::vector<int> kept;
    for (const std::vector<int>& cluster : clusters) {
      if (cluster.size() < 8) {
        kept.insert(kept.end(), cluster.begin(), cluster.end());
        continue;
      }
      Vec3 middle = Vec3::Zero();
      for (const int i : cluster) middle += input.contacts.points[i].x_a / double(cluster.size());
      std::vector<int> order = cluster;
      std::ranges::sort(order, {}, [&](int i) {
        const Vec3 d = input.contacts.points[i].x_a - middle;
        return std::atan2(d.y(), d.x());
      });
      for (std::size_t k = odd ? 1 : 0; k < order.size(); k += 2) kept.push_back(order[k]);
    }
    return kept;
  };
}

}  // namespace aussois
