// SPDX-License-Identifier: Apache-2.0
// The linking number, on which K8.plectoneme rests.
#include "examples/studies/verification/linking_number.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace aussois {
namespace {

constexpr double kRounding = 1e-9;  // of 57600 solid angles; what is wrong is off by one

// A polygon about the z axis that winds `turns` times about the circle of radius one while it goes round
// once.
std::vector<Vec3> winding(int turns, double aside) {
  constexpr int kCorners = 240;
  std::vector<Vec3> out;
  for (int i = 0; i < kCorners; ++i) {
    const double a = 2 * kPi * i / kCorners, b = turns * a;
    out.emplace_back((1 + aside * std::cos(b)) * Vec3(std::cos(a), std::sin(a), 0) +
                     aside * std::sin(b) * Vec3::UnitZ());
  }
  return out;
}

TEST(LinkingNumber, CountsHowOftenOneWindsAboutTheOther) {
  const std::vector<Vec3> middle = winding(0, 0);
  for (const int turns : {-3, -1, 0, 1, 2, 7}) {
    const double linked = linking_number(middle, winding(turns, 0.3));
    EXPECT_NEAR(std::abs(linked), std::abs(turns), kRounding);
    EXPECT_NEAR(linked, -linking_number(middle, winding(-turns, 0.3)), kRounding) << "its mirror image";
    EXPECT_NEAR(linked, linking_number(winding(turns, 0.3), middle), kRounding);
  }
}

TEST(LinkingNumber, OfSquaresThatHangInEachOtherIsOneAndApartZero) {
  const std::vector<Vec3> flat{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
      through{{1, 1, -1}, {1, 1, 1}, {4, 1.1, 1}, {4, 1.1, -1}};
  EXPECT_NEAR(std::abs(linking_number(flat, through)), 1, kRounding);
  std::vector<Vec3> apart = through;
  for (Vec3& x : apart) x.x() += 10;
  EXPECT_NEAR(linking_number(flat, apart), 0, kRounding);
}

}  // namespace
}  // namespace aussois
