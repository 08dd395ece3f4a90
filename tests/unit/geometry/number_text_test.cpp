// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry/check.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

TEST(NumberText, IsTheShortestThatReadsBack) {
  EXPECT_EQ(number_text(6e-6), "6e-06");
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(number_text(-3), "-3");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double part = random.uniform(-1, 1), x = part * std::exp(random.uniform(-600, 600));
    const std::string text = number_text(x);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    ASSERT_EQ(back, x) << text;
  }
}

TEST(Counted, KnowsOneFromMany) {
  EXPECT_EQ(counted_noun(0, "step"), "0 steps");
  EXPECT_EQ(counted_noun(1, "step"), "1 step");
  EXPECT_EQ(counted_noun(2, "step"), "2 steps");
  EXPECT_EQ(counted_noun(1, "vertex welded", "vertices welded"), "1 vertex welded");
  EXPECT_EQ(counted_noun(3'000'000'000, "vertex welded", "vertices welded"), "3000000000 vertices welded");
}

TEST(RequireField, NamesFieldValueAndBound) {
  EXPECT_NO_THROW(require_field(true, "x", 1, "be positive"));
  EXPECT_EQ(message_of([] { require_field(false, "--dilation", 6e-6, "be less"); }),
            "--dilation = 6e-06 must be less");
  EXPECT_EQ(message_of([] { require_field(false, "levels", 2, "lie in [3, 16]"); }),
            "levels = 2 must lie in [3, 16]");
  EXPECT_EQ(message_of([] { require_field(false, "name", std::string("a"), "be b"); }), "name = a must be b");
}

}  // namespace
}  // namespace aussois
