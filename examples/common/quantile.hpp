// SPDX-License-Identifier: Apache-2.0
// Quantiles by nearest rank.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace aussois {

/// The least value that `part` of all values, in (0, 1], do not exceed; NaN of none.
inline double quantile(std::vector<double> values, double part) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + std::ptrdiff_t(std::ceil(part * double(values.size()))) - 1;
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace aussois
