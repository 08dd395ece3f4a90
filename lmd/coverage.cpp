// SPDX-License-Identifier: Apache-2.0
#include "lmd/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "lmd/find_contacts.hpp"

namespace aussois {

double gap_beyond_distance(const PosedShape& a, const PosedShape& b, double distance, int threads) {
  const double expected = distance - a.shape->radius - b.shape->radius;
  const double threshold = std::max(0.0, expected + 2 * coverage_tolerance(*a.shape, *b.shape));
  return smallest_gap(find_contacts(a, b, {.threshold = threshold, .threads = threads})) - expected;
}

bool is_covered(const PosedShape& a, const PosedShape& b, double distance, int threads) {
  return distance < 1e-3 * (a.shape->radius + b.shape->radius) ||
         std::abs(gap_beyond_distance(a, b, distance, threads)) <= coverage_tolerance(*a.shape, *b.shape);
}

double coverage_tolerance(const LmdShape& a, const LmdShape& b) {
  return 2 * (a.tolerance + b.tolerance);
}

}  // namespace aussois
