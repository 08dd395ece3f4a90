// SPDX-License-Identifier: Apache-2.0
#include "reduction/clusters.hpp"

#include <algorithm>
#include <cmath>

#include "reduction/contact_order.hpp"

namespace aussois {

Clusters clusters_by_angle(const ContactSet& found, double angle) {
  const auto normal = [&](int i) -> const Vec3& { return found.points[i].normal; };
  const double chord = 2 * std::sin(angle / 2);
  const auto of_one_pair = [&](int i, int j) { return same_pair(found.points[i], found.points[j]); };
  std::vector<int> order = canonical_order(found);
  const std::vector<std::span<int>> pairs = runs_of(std::span(order), of_one_pair);
  Clusters clusters;
  clusters.reserve(pairs.size());
  for (const std::span<int> pair : pairs) {
    if (pair.size() == 1) {  // as of two balls
      clusters.emplace_back(1, pair.front());
      continue;
    }
    for (auto seed = pair.begin(); seed != pair.end();) {
      const Vec3& n = normal(*seed);
      const auto rest =
          std::stable_partition(seed, pair.end(), [&](int i) { return (normal(i) - n).norm() <= chord; });
      clusters.emplace_back(seed, rest);
      seed = rest;
    }
  }
  return clusters;
}

Clusters parts_of(const std::vector<int>& members, const std::vector<int>& label) {
  Clusters parts;
  for (std::size_t k = 0; k < members.size(); ++k) {
    parts.resize(std::max(parts.size(), std::size_t(label[k]) + 1));
    parts[label[k]].push_back(members[k]);
  }
  std::erase_if(parts, [](const std::vector<int>& part) { return part.empty(); });
  return parts;
}

std::span<const int> closed_layer(const ContactSet& found, std::span<const int> cluster, double layer) {
  const auto gap = [&](int i) { return found.points[i].gap; };
  const auto open =
      std::ranges::find_if(cluster, [&](int i) { return gap(i) > gap(cluster.front()) + layer; });
  return {cluster.begin(), open};
}

}  // namespace aussois
