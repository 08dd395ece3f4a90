// SPDX-License-Identifier: Apache-2.0
#include "reduction/hull_area_loss.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

#include "geometry/polygon.hpp"

namespace aussois {
namespace {

double triangle(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a) / 2;
}

std::vector<int> in_order(std::vector<int> members) {
  std::sort(members.begin(), members.end());
  return members;
}

}  // namespace

// For every diagonal the farthest corner on either side; both move on as the diagonal turns.
std::vector<int> largest_quadrilateral(const PlanarPatch& patch) {
  const std::size_t h = patch.hull.size();
  if (h <= 4) return in_order(patch.hull);
  const auto at = [&](std::size_t i) -> const Vec2& { return patch.x[patch.hull[i % h]]; };
  double largest = -1;
  std::size_t best[4] = {0, 0, 0, 0};
  for (std::size_t i = 0; i < h; ++i) {
    std::size_t right = i + 1, left = i + 3;
    for (std::size_t j = i + 2; j + 1 < i + h; ++j) {
      while (right + 1 < j && triangle(at(i), at(right + 1), at(j)) > triangle(at(i), at(right), at(j)))
        ++right;
      left = std::max(left, j + 1);
      while (left + 1 < i + h && triangle(at(i), at(j), at(left + 1)) > triangle(at(i), at(j), at(left)))
        ++left;
      const double area = triangle(at(i), at(right), at(j)) + triangle(at(i), at(j), at(left));
      if (area > largest * (1 + kSamePlace)) {  // the first of equal ones
        largest = area;
        best[0] = i, best[1] = right, best[2] = j, best[3] = left;
      }
    }
  }
  std::vector<int> out;
  for (const std::size_t i : best) out.push_back(patch.hull[i % h]);
  return in_order(out);
}

std::vector<int> least_area_removed(const PlanarPatch& patch, int corners) {
  const std::size_t h = patch.hull.size();
  std::vector<std::size_t> before(h), after(h), version(h, 0);
  const auto at = [&](std::size_t i) -> const Vec2& { return patch.x[patch.hull[i]]; };
  using Entry = std::tuple<double, std::size_t, std::size_t>;  // area, corner, its version
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> smallest;
  const auto offer = [&](std::size_t i) {
    smallest.emplace(triangle(at(before[i]), at(i), at(after[i])), i, version[i]);
  };
  for (std::size_t i = 0; i < h; ++i) before[i] = (i + h - 1) % h, after[i] = (i + 1) % h;
  for (std::size_t i = 0; i < h; ++i) offer(i);
  std::vector<char> removed(h, 0);
  for (std::size_t left = h; left > std::size_t(corners) && left > 3;) {
    const auto [area, i, seen] = smallest.top();
    smallest.pop();
    if (removed[i] || seen != version[i]) continue;
    removed[i] = 1;
    --left;
    after[before[i]] = after[i];
    before[after[i]] = before[i];
    for (const std::size_t neighbour : {before[i], after[i]}) {
      ++version[neighbour];
      offer(neighbour);
    }
  }
  std::vector<int> out;
  for (std::size_t i = 0; i < h; ++i)
    if (!removed[i]) out.push_back(patch.hull[i]);
  return in_order(out);
}

std::vector<int> hull_area_loss(const PlanarPatch& patch, int corners) {
  return corners == 4 ? largest_quadrilateral(patch) : least_area_removed(patch, corners);
}

}  // namespace aussois
