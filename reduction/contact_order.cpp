// SPDX-License-Identifier: Apache-2.0
#include "reduction/contact_order.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace aussois {

std::vector<int> canonical_order(const ContactSet& found) {
  const auto key = [&](int i) {
    const ContactPoint& c = found.points[std::size_t(i)];
    const Vec3 at = 0.5 * (c.x_a + c.x_b);
    return std::make_tuple(c.a.body, c.b.body, c.gap, c.a.dim, c.a.simplex, c.b.dim, c.b.simplex, at.x(),
                           at.y(), at.z());
  };
  std::vector<int> order(found.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return key(i) < key(j); });
  return order;
}

}  // namespace aussois
