// SPDX-License-Identifier: Apache-2.0
// What Random draws itself is the same with every compiler and library.
#include "tests/support/random.hpp"

#include <gtest/gtest.h>

namespace aussois {
namespace {

TEST(Random, GivesTheSameNumbersEverywhere) {
  Random random(1);
  EXPECT_EQ(random.uniform(), 0.13387664401253263);
  const SE3 g = random.pose(1);
  const Quat R(0.99317420523833244, -0.039658856908483246, 0.10941504748310481, -0.007779492412050195);
  EXPECT_LT((R.coeffs() - g.R.coeffs()).norm(), 1e-15);
  EXPECT_EQ(g.p, Vec3(0.13969429740419326, 0.27046243662747216, -0.82109361271069115));
  EXPECT_NEAR(random.normal(), 0.31428574584424079, 1e-15);
}

}  // namespace
}  // namespace aussois
