// SPDX-License-Identifier: Apache-2.0
// What leaves through a port, with the bodies of the kernel behind it (PORT-3).
#include "examples/studies/haptic/haptic_trial.hpp"

#include <gtest/gtest.h>

namespace aussois {
namespace {

constexpr double kHidden = 1.5e-3;  // the need: what encoders of 10 um may hide at tens of newtons [J]

struct Rate {
  int every = 1, late = 0;
};
using Pushing = std::tuple<HapticScene, HandKind, int>;
constexpr Rate kRates[] = {{1, 0}, {3, 0}, {10, 0}, {1, 3}};

HapticTrial trial_of(const Pushing& of, int pushes) {
  const Rate rate = kRates[std::get<2>(of)];
  return {.scene = std::get<0>(of),
          .hand = std::get<1>(of),
          .every = rate.every,
          .late = rate.late,
          .pushes = pushes};
}

void expect_bounded(const HapticTrial& trial) {
  const HapticResult r = haptic_trial(trial);
  EXPECT_FALSE(r.flew_off);
  EXPECT_FALSE(r.refused);
  EXPECT_EQ(r.unsolved, 0);
  EXPECT_EQ(r.beyond, 0);
  EXPECT_GT(r.events, 0);
  EXPECT_LE(r.excess, trial.reserve.lend * (1 + 1e-9));
  EXPECT_LE(r.true_excess, trial.reserve.lend + kHidden);
}

class Ports : public testing::TestWithParam<Pushing> {};

TEST_P(Ports, GiveNoMoreThanIsStoredAndLent) {
  expect_bounded(trial_of(GetParam(), 3));
}
// Of each hand in each setting; 100 000 in all.
TEST_P(Ports, GiveNoMoreInALongRun) {
  expect_bounded(trial_of(GetParam(), 1700));
}

INSTANTIATE_TEST_SUITE_P(With, Ports,
                         testing::Combine(testing::Values(HapticScene::wall, HapticScene::slot,
                                                          HapticScene::wedge),
                                          testing::Values(HandKind::loose, HandKind::soft, HandKind::firm,
                                                          HandKind::rigid, HandKind::shaking),
                                          testing::Range(0, 4)),
                         [](const testing::TestParamInfo<Pushing>& of) {
                           const Rate rate = kRates[std::get<2>(of.param)];
                           return std::string(name_of(std::get<0>(of.param), kHapticScenes)) + "_" +
                                  name_of(std::get<1>(of.param), kHandKinds) + "_" +
                                  std::to_string(rate.every) + "_" + std::to_string(rate.late);
                         });

// Bodies that step a tenth as often, and no local model: a hand gets ten times what may be lent, and the
// reserve keeps it within. With the local model there is little left for the reserve to do.
TEST(Port, IsBoundedByTheReserveWhereAHeldForceIsNot) {
  HapticTrial trial{
      .hand = HandKind::loose, .way = HapticWay::held, .stiffness = 8e3, .every = 10, .pushes = 20};
  const double lent = trial.reserve.lend;
  EXPECT_GT(haptic_trial(trial).excess, 10 * lent);
  trial.way = HapticWay::held_reserve;
  const HapticResult kept = haptic_trial(trial);
  EXPECT_LE(kept.excess, lent * (1 + 1e-9));
  EXPECT_GT(kept.excess, lent / 2);
  EXPECT_GT(kept.changed, 0.01);
  trial.way = HapticWay::local;
  EXPECT_LT(haptic_trial(trial).excess, lent);
}

TEST(Port, IsLeftAloneByTheReserveAtTheRateOfTheDevice) {
  for (const HandKind hand : {HandKind::loose, HandKind::soft, HandKind::firm, HandKind::rigid})
    for (const double stiffness : {2e3, 8e3})
      EXPECT_LT(haptic_trial({.hand = hand, .stiffness = stiffness, .pushes = 5}).changed, 1e-3);
}

}  // namespace
}  // namespace aussois
