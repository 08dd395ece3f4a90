// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "geometry/check.hpp"

namespace aussois {
namespace {

bool seen = false;
[[maybe_unused]] bool see() {  // in presets without assertions
  seen = true;
  return true;
}

TEST(Assertions, AreEvaluatedInDebugPresetsOnly) {
  AUSSOIS_ASSERT(see());
  EXPECT_EQ(seen, bool(EXPECT_ASSERTIONS));
}

#if EXPECT_ASSERTIONS
TEST(AssertionsDeathTest, NameThePlaceAndTheBrokenCondition) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(AUSSOIS_ASSERT(1 + 1 == 3), "assertions_test.cpp:[0-9]+: broken: 1 \\+ 1 == 3");
}
#endif

}  // namespace
}  // namespace aussois
