// SPDX-License-Identifier: Apache-2.0
#include "geometry/all_finite.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/geometry/samples.hpp"

namespace aussois {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(AllFinite, SaysWhatEigenSaysOfEveryEntry) {
  Random random(20123);
  for (int size = 0; size < 20; ++size) {
    VecX x(size);
    for (double& value : x) {
      const double size_of_value = std::pow(10, random.uniform(-300, 308));
      value = size_of_value * random.uniform(-1, 1);
    }
    EXPECT_TRUE(all_finite(x)) << size;
    for (int i = 0; i < size; ++i)
      for (const double wrong : {kInf, -kInf, kNan}) {
        VecX y = x;
        y[i] = wrong;
        EXPECT_FALSE(all_finite(y)) << size << ", " << i;
        EXPECT_FALSE(y.allFinite());
        y[size - 1 - i] = -wrong;  // infinities of both signs
        EXPECT_FALSE(all_finite(y)) << size << ", " << i;
      }
  }
}

TEST(AllFinite, LooksAtPositionAndRotationOfAPose) {
  EXPECT_TRUE(all_finite(translation(1e308, -1e308, 0)));
  for (int i = 0; i < 3; ++i) {
    SE3 g;
    g.p[i] = kInf;
    EXPECT_FALSE(all_finite(g));
    EXPECT_FALSE(all_finite(std::vector<SE3>{{}, g}));
  }
  EXPECT_TRUE(all_finite(std::vector<SE3>(2)));
  for (int i = 0; i < 4; ++i) {
    SE3 g;
    g.R.coeffs()[i] = kNan;
    EXPECT_FALSE(all_finite(g));
  }
}

}  // namespace
}  // namespace aussois
