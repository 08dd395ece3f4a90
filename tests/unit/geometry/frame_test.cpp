// SPDX-License-Identifier: Apache-2.0
#include "geometry/frame.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

TEST(Frame, IsRightHandedForAnyNormal) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = i == 0 ? Vec3(0, 0, -1) : i == 1 ? Vec3(0, 0, 1) : random.direction();
    const Mat3 frame = frame_of(n);
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(frame.determinant(), 1, 1e-14);
    EXPECT_EQ(frame.col(0), n);
  }
}

}  // namespace
}  // namespace aussois
