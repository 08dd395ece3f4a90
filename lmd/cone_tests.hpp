// SPDX-License-Identifier: Apache-2.0
// Tests the normal cones of nodes: do their caps oppose each other, and does the direction between them meet
// both (LMD-9)?
#pragma once

#include <algorithm>
#include <cmath>

#include "lmd/dual_descent.hpp"

namespace aussois {

/// cos and sin of an angle in [0, pi].
struct Angle {
  float cos = 1, sin = 0;
};
inline Angle angle_of(double value) {
  return {float(std::cos(std::min(value, kPi))), float(std::sin(std::min(value, kPi)))};
}

/// Are the directions at most the sum of the angles apart, given the cosine between them? A sum beyond pi,
/// where its sine is negative, is always enough.
AUSSOIS_INLINE I4 within(F4 cos_between, F4 cos_a, F4 sin_a, F4 cos_b, F4 sin_b) {
  constexpr float kRounding = 2e-6F;  // of sums and products of cosines in single precision
  const F4 cos = cos_a * cos_b - sin_a * sin_b, sin = sin_a * cos_b + cos_a * sin_b;
  return (sin <= 0) | (cos_between + kRounding >= cos);
}

/// By how much caps are enlarged, and which side of their faces the trees look at: -1 the back.
struct CapLimits {
  Angle opposing{}, enlarged_a{}, enlarged_b{};
  float side_a = 1, side_b = 1;
};

/// Whether some direction of the slot's cap opposes one of the four.
AUSSOIS_INLINE I4 caps_oppose(const ConeNode& four, const ConeSlot& one, const CapLimits& limits) {
  const float own_cos = one.node->cos[one.lane], own_sin = one.node->sin[one.lane];
  // caps enlarged by the half angle of the slot: `opposing` may carry it past pi, then nothing is outside
  const float c = own_cos * limits.opposing.cos - own_sin * limits.opposing.sin;
  const float s = own_sin * limits.opposing.cos + own_cos * limits.opposing.sin;
  if (!(s > 0)) return I4{-1, -1, -1, -1};
  return within(-limits.side_a * limits.side_b * dot(load4(four.axis), spread(one.node->axis, one.lane)),
                load4(four.cos), load4(four.sin), splat(c), splat(s));
}

/// Of the direction from the slot to the four only a cone around `d` is known, where their balls, of radii
/// that sum up to `both`, do not meet; `square` is that of d.
AUSSOIS_INLINE I4 directions_meet(const ConeNode& four, const ConeSlot& one, bool one_is_a, const V4& d,
                                  F4 both, F4 square, const CapLimits& limits) {
  const F4 inverse = 1.0F / sqrt4(square);
  const F4 sin_phi = both * inverse;
  const I4 meeting = ~(sin_phi < 0.999F);  // also where both are points at one place
  const F4 room = 1.0F - sin_phi * sin_phi;
  const F4 cos_phi = sqrt4(room > 0 ? room : splat(0));
  const Angle& e_one = one_is_a ? limits.enlarged_a : limits.enlarged_b;
  const Angle& e_four = one_is_a ? limits.enlarged_b : limits.enlarged_a;
  const float side_one = one_is_a ? limits.side_a : limits.side_b;
  const float side_four = one_is_a ? limits.side_b : limits.side_a;
  const float own_cos = one.node->cos[one.lane], own_sin = one.node->sin[one.lane];
  const float c = own_cos * e_one.cos - own_sin * e_one.sin, s = own_sin * e_one.cos + own_cos * e_one.sin;
  I4 meet = {-1, -1, -1, -1};
  if (s > 0)
    meet = within(side_one * dot(spread(one.node->axis, one.lane), d) * inverse, splat(c), splat(s), cos_phi,
                  sin_phi);
  const F4 cos = load4(four.cos), sin = load4(four.sin);
  const F4 cf = cos * e_four.cos - sin * e_four.sin, sf = sin * e_four.cos + cos * e_four.sin;
  meet &= (sf <= 0) | within(-side_four * dot(load4(four.axis), d) * inverse, cf, sf, cos_phi, sin_phi);
  return meet | meeting;
}

}  // namespace aussois
