// SPDX-License-Identifier: Apache-2.0
#include "ports/simulated_hand.hpp"

#include <cmath>

#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

class Hands : public testing::TestWithParam<HandKind> {};

TEST_P(Hands, DoTheSameWithTheSameSeed) {
  const auto place = [](std::uint64_t seed) {
    SimulatedHand hand(GetParam(), {.jitter = 0.2, .lost = 0.01}, {.aside = 1e-3, .turn = 0.1}, seed);
    for (int k = 0; k < 2000; ++k) (void)hand.live({{0.1 * std::sin(0.01 * k), 0, 0.2}, {0, 1e-3, 0}});
    return hand.handle();
  };
  const SE3 a = place(1), b = place(1), c = place(2);
  EXPECT_EQ(a.p, b.p);
  EXPECT_EQ(a.R.coeffs(), b.R.coeffs());
  if (GetParam() != HandKind::shaking) {
    EXPECT_NE(a.p, c.p);
  }
}

// In the open they go where they want: `deep` beyond home at most, and back.
TEST_P(Hands, ReachInAndBack) {
  const Reaching reaching{.into = Vec3::UnitX(), .shallow = 5e-3, .deep = 10e-3};
  SimulatedHand hand(GetParam(), {}, reaching, 3);
  double deepest = 0, last = 0;
  while (hand.pushes() < 20) {
    const DeviceSample sample = hand.live({});
    deepest = std::max(deepest, sample.pose.p.x());
    last = sample.time;
    EXPECT_LT((sample.pose.p - hand.handle().p).lpNorm<Eigen::Infinity>(),
              0.51e-5);  // a count of the encoder
  }
  EXPECT_GT(deepest, 5e-3);
  if (GetParam() == HandKind::rigid) {
    EXPECT_LT(deepest, 10.01e-3);  // others swing over, since nothing is there
  }
  if (GetParam() == HandKind::shaking) {
    EXPECT_LT(deepest, 12.51e-3);  // 5 mm about the middle
  }
  EXPECT_GT(last, 0.05);
  EXPECT_EQ(hand.given(), 0);
}

// Energy by a force that is constant is the force times the way.
TEST_P(Hands, CountWhatTheyAreGiven) {
  SimulatedHand hand(GetParam(), {}, {.turn = 0.2}, 4);
  const DeviceForce force{{0, 0, 0.5}, {0, 0, 0}};
  for (int k = 0; k < 3000; ++k) (void)hand.live(force);
  EXPECT_NEAR(hand.given(), force.force.dot(hand.handle().p), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Of, Hands,
                         testing::Values(HandKind::loose, HandKind::soft, HandKind::firm, HandKind::rigid,
                                         HandKind::shaking),
                         [](const testing::TestParamInfo<HandKind>& of) {
                           return std::string(name_of(of.param, kHandKinds));
                         });

TEST(SimulatedHand, LimitsWhatTheDeviceGives) {
  SimulatedHand hand(HandKind::firm, {.force_limit = 2, .torque_limit = 0.1}, {}, 5);
  (void)hand.live({{0, 30, 40}, {3, 0, 4}});
  EXPECT_NEAR((hand.held().force - Vec3(0, 1.2, 1.6)).norm(), 0, 1e-12);
  EXPECT_NEAR(hand.held().torque.norm(), 0.1, 1e-12);
}

TEST(SimulatedHand, RepeatsASampleThatIsLost) {
  SimulatedHand hand(HandKind::rigid, {.lost = 0.5}, {}, 6);
  int repeated = 0;
  std::uint64_t last = 0;
  for (int k = 0; k < 1000; ++k) {
    const DeviceSample sample = hand.live({});
    repeated += sample.serial == last;
    last = sample.serial;
  }
  EXPECT_NEAR(repeated, 500, 80);  // five standard deviations
}

TEST(SimulatedHand, RefusesADeviceOutOfRange) {
  expect_names(message_of([] { SimulatedHand(HandKind::soft, {.mass = 0}, {}, 1); }), "mass = 0");
  expect_names(message_of([] { SimulatedHand(HandKind::soft, {.jitter = 0.6}, {}, 1); }), "jitter = 0.6");
}

}  // namespace
}  // namespace aussois
