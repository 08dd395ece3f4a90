// SPDX-License-Identifier: Apache-2.0
// Derivatives of smooth functions by differences.
#pragma once

#include <type_traits>

namespace aussois {

/// f'(0) of a function of one number, of fourth order: truncation and rounding are below 1e-9 where f and its
/// derivatives are of order one.
template <class Function>
auto slope(const Function& f) {
  constexpr double d = 1e-3;
  using Out = std::decay_t<decltype(f(0.0))>;
  return Out((8.0 * (f(d) - f(-d)) - (f(2 * d) - f(-2 * d))) / (12 * d));
}

}  // namespace aussois
