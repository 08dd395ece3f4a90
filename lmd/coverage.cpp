// SPDX-License-Identifier: Apache-2.0
#include "lmd/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "lmd/find_contacts.hpp"

namespace aussois {

bool bases_all_but_touch(const LmdShape& a, const LmdShape& b, double distance) {
  return distance < 1e-3 * (a.radius + b.radius);
}

double gap_beyond_distance(const PosedShape& a, const PosedShape& b, double distance, int threads) {
  const double expected = distance - a.shape->radius - b.shape->radius;
  const double threshold = std::max(0.0, expected + 2 * coverage_tolerance(a, b));
  return smallest_gap(find_contacts(a, b, {.threshold = threshold, .threads = threads})) - expected;
}

bool is_covered(const PosedShape& a, const PosedShape& b, double distance, int threads) {
  return bases_all_but_touch(*a.shape, *b.shape, distance) ||
         std::abs(gap_beyond_distance(a, b, distance, threads)) <= coverage_tolerance(a, b);
}

bool is_covered_by(double smallest_gap, const PosedShape& a, const PosedShape& b, double distance) {
  return bases_all_but_touch(*a.shape, *b.shape, distance) ||
         std::abs(smallest_gap - (distance - a.shape->radius - b.shape->radius)) <= coverage_tolerance(a, b);
}

double coverage_tolerance(const PosedShape& a, const PosedShape& b) {
  return 2 * (a.shape->tolerance + b.shape->tolerance) + rounding_of_distance(a, b);
}

double rounding_of_distance(const PosedShape& a, const PosedShape& b) {
  const auto extent = [](const PosedShape& posed) {
    const LmdShape& shape = *posed.shape;
    return posed.g_ws.p.norm() + shape.centre.norm() + shape.bounding_radius + shape.radius;
  };
  return 1e-14 * (extent(a) + extent(b));
}

}  // namespace aussois
