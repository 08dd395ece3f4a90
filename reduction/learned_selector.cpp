// SPDX-License-Identifier: Apache-2.0
#include "reduction/learned_selector.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

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

bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 x = b - a, y = c - a;
  const double longest = std::max({x.squaredNorm(), y.squaredNorm(), (c - b).squaredNorm()});
  return x.cross(y).norm() <= kFlat * longest;
}

std::vector<int> chosen_places(const VecX& probability, const std::vector<Vec3>& places, int keep) {
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  const VecX p = probability.array().isNaN().select(-1, probability);  // what is no number comes last
  std::ranges::stable_sort(order, std::ranges::greater(), [&](int i) { return p[i]; });
  std::vector<int> chosen;
  for (const int i : order) {
    if (int(chosen.size()) == keep) break;
    const auto at = [&](std::size_t k) { return places[chosen[k]]; };
    if (chosen.size() == 2 && are_collinear(at(0), at(1), places[i])) continue;
    chosen.push_back(i);
  }
  return chosen;
}

VecX input_of(const BodyLoad& load) {
  VecX x(kLoadInputs);
  x << load.g_wb.p, load.g_wb.R.toRotationMatrix().reshaped(), load.twist, load.wrench;
  return x;
}

ContactSelector contact_selector(LearnedSelector selector, BodyId body) {
  validate(selector);
  require_field(selector.network.inputs() == kLoadInputs, "LearnedSelector::network.inputs()",
                selector.network.inputs(), "be 24");
  return [selector = std::move(selector), body](const ReductionInput& input, const Clusters& clusters) {
    require_field(input.bodies.contains(body), "body", body, "name a body whose load is in the input");
    const BodyLoad& load = input.bodies[body];
    const std::vector<int> places =
        chosen_places(network_output(selector.network, input_of(load)), selector.places, selector.keep);
    std::vector<int> kept;
    for (const std::vector<int>& cluster : clusters) {
      const ContactPoint& first = input.contacts.points[cluster.front()];
      if ((first.a.body != body && first.b.body != body) || int(cluster.size()) <= selector.keep) {
        kept.insert(kept.end(), cluster.begin(), cluster.end());
        continue;
      }
      for (const int place : places) {
        const Vec3 wanted = load.g_wb * selector.places[place];
        kept.push_back(*std::ranges::min_element(cluster, {}, [&](int i) {
          return (mid_point(input.contacts.points[i]) - wanted).squaredNorm();
        }));
      }
    }
    return kept;
  };
}

}  // namespace aussois
