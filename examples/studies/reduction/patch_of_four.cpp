// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/reduction/patch_of_four.hpp"

#include <Eigen/Geometry>

namespace aussois {

std::vector<int> patch_of_four(const ContactSet& contacts, std::span<const int> members) {
  const auto at = [&](int k) { return mid_point(contacts.points[members[k]]); };
  const Vec3 n = contacts.points[members.front()].normal;
  const auto farthest = [&](const auto& measure) {  // of all members; -1 if none measures more than zero
    int best = -1;
    double most = 0;
    for (int k = 0; k < int(members.size()); ++k)
      if (const double m = measure(at(k)); m > most) most = m, best = k;
    return best;
  };
  const Vec3 a = at(0);
  const int second = farthest([&](const Vec3& x) { return (x - a).squaredNorm(); });
  if (second < 0) return {0};
  const Vec3 b = at(second);
  const int third = farthest([&](const Vec3& x) { return std::abs(n.dot((b - a).cross(x - a))); });
  if (third < 0) return {0, second};
  Vec3 corner[3] = {a, b, at(third)};
  if (n.dot((corner[1] - corner[0]).cross(corner[2] - corner[0])) < 0) std::swap(corner[1], corner[2]);
  const int fourth = farthest([&](const Vec3& x) {
    double area = 0;  // beyond the side that it is farthest beyond
    for (int i = 0; i < 3; ++i)
      area = std::max(area, -n.dot((corner[(i + 1) % 3] - corner[i]).cross(x - corner[i])));
    return area;
  });
  return fourth < 0 ? std::vector<int>{0, second, third} : std::vector<int>{0, second, third, fourth};
}

ContactSelector patch_of_four_selector() {
  return [](const ReductionInput& input, const Clusters& clusters) {
    std::vector<int> kept;
    for (const std::vector<int>& cluster : clusters) {
      if (cluster.size() <= 4) {
        kept.insert(kept.end(), cluster.begin(), cluster.end());
        continue;
      }
      for (const int k : patch_of_four(input.contacts, cluster)) kept.push_back(cluster[k]);
    }
    return kept;
  };
}

}  // namespace aussois
