// SPDX-License-Identifier: Apache-2.0
// Asks vectors and poses for infinities and NaN, many entries at a time: Eigen's allFinite() takes them one
// by one.
#pragma once

#include <algorithm>
#include <concepts>
#include <ranges>

#include "geometry/se3.hpp"
#include "geometry/types.hpp"

namespace aussois {

template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& x) {
  return (x.derived() - x.derived()).sum() == 0;  // infinity - infinity is NaN
}

inline bool all_finite(const SE3& g) {
  return all_finite(g.p) && all_finite(g.R.coeffs());
}

template <std::ranges::input_range Poses>
requires std::same_as<std::ranges::range_value_t<Poses>, SE3>
bool all_finite(const Poses& poses) {
  return std::ranges::all_of(poses, [](const SE3& g) { return all_finite(g); });
}

}  // namespace aussois
