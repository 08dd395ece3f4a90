// SPDX-License-Identifier: Apache-2.0
#include "reduction/clusters.hpp"

#include <algorithm>
#include <cmath>

#include "reduction/contact_order.hpp"

namespace aussois {

Clusters clusters_of(const ContactSet& found, double angle) {
  const std::vector<ContactPoint>& c = found.points;
  std::vector<int> order = canonical_order(found);

  const double chord = 2 * std::sin(angle / 2);
  Clusters clusters;
  for (auto begin = order.begin(); begin != order.end();) {  // one body pair after the other
    const ContactPoint& first = c[std::size_t(*begin)];
    const auto end = std::find_if(begin, order.end(), [&](int i) {
      const ContactPoint& x = c[std::size_t(i)];
      return x.a.body != first.a.body || x.b.body != first.b.body;
    });
    for (auto seed = begin; seed != end;) {
      const Vec3 normal = c[std::size_t(*seed)].normal;
      const auto rest = std::stable_partition(
          seed, end, [&](int i) { return (c[std::size_t(i)].normal - normal).norm() <= chord; });
      clusters.emplace_back(seed, rest);
      seed = rest;
    }
    begin = end;
  }
  return clusters;
}

}  // namespace aussois
