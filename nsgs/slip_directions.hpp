// SPDX-License-Identifier: Apache-2.0
// All ways in which one contact with three rows may slip (ONE-4), (ONE-5). Private to nsgs.
#pragma once

#include <array>

#include "geometry/types.hpp"

namespace aussois {

struct SlipCandidates {
  std::array<Vec3, 16> r{};
  int count = 0;
};

/// Impulses with u_N = 0, r_N >= 0, r_T against a direction that u_T = (W r + q)_T may have or nearly has:
/// the caller judges them. Roots are found to neighbouring numbers.
SlipCandidates slip_candidates(const Mat3& W, const Vec3& q, double mu);

}  // namespace aussois
