// SPDX-License-Identifier: Apache-2.0
#include "reduction/learned_selector.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include <Eigen/Geometry>

#include "geometry/check.hpp"

namespace aussois {
namespace {

constexpr double kFlat = 1e-6;  // height over longest side

}  // namespace

void validate(const LearnedSelector& selector) {
  validate(selector.network);
  require(Eigen::Index(selector.places.size()) == selector.network.outputs(),
          "LearnedSelector::places has " + std::to_string(selector.places.size()) +
              " entries and must have one per output, " + std::to_string(selector.network.outputs()));
  for (const Vec3& place : selector.places)
    require(place.allFinite(), "LearnedSelector::places must be finite");
  require_field(selector.keep >= 1, "LearnedSelector::keep", selector.keep, "be at least 1");
}

bool on_a_line(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 x = b - a, y = c - a;
  const double longest = std::max({x.squaredNorm(), y.squaredNorm(), (c - b).squaredNorm()});
  return x.cross(y).norm() <= kFlat * longest;
}

std::vector<int> chosen_places(const VecX& probability, const std::vector<Vec3>& places, int keep) {
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::ranges::greater(), [&](int i) { return probability[i]; });
  std::vector<int> chosen;
  for (const int i : order) {
    if (int(chosen.size()) == keep) break;
    const auto at = [&](std::size_t k) { return places[std::size_t(chosen[k])]; };
    if (chosen.size() == 2 && on_a_line(at(0), at(1), places[std::size_t(i)])) continue;
    chosen.push_back(i);
  }
  return chosen;
}

}  // namespace aussois
