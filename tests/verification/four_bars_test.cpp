// SPDX-License-Identifier: Apache-2.0
// C7, N windows of four bars (doc/theory/mechanism_benchmarks.md): redundant in space, and with N more
// freedoms wherever all bars lie in one line. The full length is in long_mechanisms_test.cpp.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/one_angle.hpp"

namespace aussois {
namespace {

// Two windows, five rods, 35 equations for the 29 motions that are not free; 2 s, one turn: the bars lie in
// one line twice.
TEST(FourBars, TurnThroughTheirSingularPositions) {
  for (const char* scheme : {"moreau_jean", "d1_minus_linear", "passive_midpoint"}) {
    const FourBarErrors coarse = four_bar_errors(2, scheme, 4e-3, 2),
                        fine = four_bar_errors(2, scheme, 1e-3, 2);
    EXPECT_LT(fine.energy, 2e-6) << scheme;
    EXPECT_LT(fine.angle, 2e-5) << scheme;
    EXPECT_LT(fine.drift, 1e-12) << scheme;
    EXPECT_NEAR(std::log(coarse.angle / fine.angle) / std::log(4), 2, 0.2) << scheme;
  }
}

// Second order too, with fourteen times the error of the energy.
TEST(FourBars, TurnByGeneralisedAlpha) {
  const FourBarErrors fine = four_bar_errors(2, "generalised_alpha", 1e-3, 2);
  EXPECT_LT(fine.energy, 3e-5);
  EXPECT_LT(fine.angle, 2e-5);
  EXPECT_LT(fine.drift, 1e-12);
}

}  // namespace
}  // namespace aussois
