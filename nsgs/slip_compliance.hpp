// SPDX-License-Identifier: Apache-2.0
// Solves one contact with three rows, stick or slip, by its compliance (ONE-4), (ONE-5), in as many digits as
// it needs. Private to nsgs: sweeps use it where Newton fails.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

struct ExactContact {
  Vec3 r = Vec3::Zero();  // rounded to doubles
  double wrong = kInf;    // its natural map before that rounding
};

enum class Digits { sixteen, thirty_two };  // thirty-two take twenty times as long

/// For q_N < 0. There is an answer if the symmetric part of W is positive definite, whatever its condition.
ExactContact solve_by_slip_compliance(const Mat3& W, const Vec3& q, double mu, Digits digits);

}  // namespace aussois
