// SPDX-License-Identifier: Apache-2.0
#include "reduction/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace aussois {
namespace {

// Pairs one after the other, the deepest of a pair first; then whatever tells two contacts apart, so that the
// order does not depend on how the set is stored.
bool before(const ContactPoint& c, const ContactPoint& d) {
  const auto key = [](const ContactPoint& x, const Vec3& at) {
    return std::make_tuple(x.a.body, x.b.body, x.gap, x.a.dim, x.a.simplex, x.b.dim, x.b.simplex, at.x(),
                           at.y(), at.z());
  };
  return key(c, 0.5 * (c.x_a + c.x_b)) < key(d, 0.5 * (d.x_a + d.x_b));
}

}  // namespace

Clusters clusters_of(const ContactSet& found, double angle) {
  const std::vector<ContactPoint>& c = found.points;
  std::vector<int> order(c.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return before(c[std::size_t(i)], c[std::size_t(j)]); });

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
