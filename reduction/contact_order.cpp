// SPDX-License-Identifier: Apache-2.0
#include "reduction/contact_order.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace aussois {
namespace {

/// What mostly decides, side by side in memory: a set of a million contacts does not fit into a cache.
struct Rank {
  std::uint64_t bodies = 0;  // a, then b
  double gap = 0;
  std::uint64_t simplex_a = 0;  // dimension, then index
  int index = -1;
};

std::uint64_t packed(int first, int second) {  // -1: none
  return std::uint64_t(first + 1) << 32 | std::uint32_t(second + 1);
}

bool before(const ContactSet& found, const Rank& i, const Rank& j) {
  if (i.bodies != j.bodies) return i.bodies < j.bodies;
  if (i.gap != j.gap) return i.gap < j.gap;
  if (i.simplex_a != j.simplex_a) return i.simplex_a < j.simplex_a;
  const auto rest = [&](const Rank& rank) {
    const ContactPoint& c = found.points[rank.index];
    const Vec3 at = mid_point(c);
    return std::make_tuple(c.b.dim, c.b.simplex, at.x(), at.y(), at.z());
  };
  return rest(i) < rest(j);
}

}  // namespace

std::vector<int> canonical_order(const ContactSet& found) {
  std::vector<Rank> ranks;
  ranks.reserve(found.points.size());
  for (const ContactPoint& c : found.points)
    ranks.push_back(
        {packed(c.a.body.index(), c.b.body.index()), c.gap, packed(c.a.dim, c.a.simplex), int(ranks.size())});
  const auto in_order = [&](const Rank& i, const Rank& j) { return before(found, i, j); };
  if (!std::is_sorted(ranks.begin(), ranks.end(), in_order))  // of balls and corners alone it mostly is
    std::sort(ranks.begin(), ranks.end(), in_order);
  std::vector<int> order;
  order.reserve(ranks.size());
  for (const Rank& rank : ranks) order.push_back(rank.index);
  return order;
}

std::vector<std::vector<int>> contacts_by_pair(const ContactSet& found) {
  const std::vector<int> order = canonical_order(found);
  const auto point = [&](int i) -> const ContactPoint& { return found.points[i]; };
  std::vector<std::vector<int>> pairs;
  for (const std::span<const int> pair :
       runs_of(std::span(order), [&](int i, int j) { return same_pair(point(i), point(j)); }))
    pairs.emplace_back(pair.begin(), pair.end());
  return pairs;
}

}  // namespace aussois
