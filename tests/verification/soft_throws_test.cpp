// SPDX-License-Identifier: Apache-2.0
// A hundred thousand throws of the row S2.throws, in slices.
#include "examples/studies/verification/soft_throws.hpp"

#include <gtest/gtest.h>

namespace aussois {
namespace {

class SoftThrows : public ::testing::TestWithParam<int> {};

TEST_P(SoftThrows, GoThroughNothingTenThousandTimes) {
  constexpr int kCount = 10000;
  const ThrowTally tally = throw_soft_parts(std::uint64_t(1 + kCount * GetParam()), kCount);
  EXPECT_EQ(tally.violations, 0);
  EXPECT_EQ(tally.refused, 0);
  EXPECT_GT(tally.touched, kCount / 2);
}

INSTANTIATE_TEST_SUITE_P(InSlices, SoftThrows, ::testing::Range(0, 10));

}  // namespace
}  // namespace aussois
