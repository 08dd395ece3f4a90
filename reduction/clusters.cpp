// SPDX-License-Identifier: Apache-2.0
#include "reduction/clusters.hpp"

#include <algorithm>
#include <cmath>

#include "reduction/contact_order.hpp"
#include "reduction/point_grid.hpp"

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
    // Each joins the first seed within the chord, and is one if there is none. Seeds are apart: few are near.
    const std::size_t first = clusters.size();
    PointGrid seeds(Vec3::Constant(-1.1), Vec3::Constant(1.1), 2 * chord, pair.size());
    for (const int i : pair) {
      std::size_t cluster = clusters.size();
      seeds.for_each_near(normal(i), chord, [&](std::size_t k) {
        if ((normal(i) - normal(clusters[first + k].front())).norm() <= chord)
          cluster = std::min(cluster, first + k);
      });
      if (cluster == clusters.size()) clusters.emplace_back(), seeds.add(normal(i));
      clusters[cluster].push_back(i);
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
