// SPDX-License-Identifier: Apache-2.0
// C9, Andrews' squeezing mechanism (doc/theory/mechanism_benchmarks.md), against the published end values.
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "integrators/event_driven.hpp"
#include "mechanics/mechanism.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kEnd = 0.03;
// The test set for initial value problems of the university of Bari, to 14 digits.
constexpr double kAngles[7] = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                               -0.5347301163226948, 0.5244099658805304, 0.5347301163226948,
                               1.048080741042263};

double largest_error(const CaseScene& s, const State& end) {
  double worst = 0;
  for (int i = 0; i < 7; ++i)
    worst = std::max(worst, std::abs(joint_coordinate(s.model, end, i) + kSqueezerStart[i] - kAngles[i]));
  return worst;
}

// The accelerations that the test set gives for the start: all bodies, joints, the spring and the motor.
TEST(Squeezer, StartsWithThePublishedAccelerations) {
  const CaseScene s = squeezer();
  EXPECT_LT(joint_error(s.model, s.state).translation, 1e-15);
  constexpr double kStep = 1e-6;
  const State end = run_scene(s, "moreau_jean", mechanism_options(kStep), kStep);
  const double acceleration[7] = {14222.4439199541, -10666.8329399656, 0, 0, 0, 0, 0};
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(joint_speed(s.model, end, i) / kStep, acceleration[i], 2e-3) << "joint " << i;
}

class Squeezed : public ::testing::TestWithParam<std::string> {};

// 1e-4 at h = 10 us, over two and a half turns of the crank in 30 ms; of second order.
TEST_P(Squeezed, EndsWhereTheTestSetSays) {
  const CaseScene s = squeezer();
  const double fine = largest_error(s, run_scene(s, GetParam(), mechanism_options(1e-5), kEnd)),
               coarse = largest_error(s, run_scene(s, GetParam(), mechanism_options(2e-5), kEnd));
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}
INSTANTIATE_TEST_SUITE_P(By, Squeezed,
                         ::testing::Values("moreau_jean", "generalised_alpha", "d1_minus_linear"),
                         [](const auto& scheme) { return scheme.param; });

// The rotation by Cayley's map lags by a twelfth of the cube of its angle: twice the error.
TEST(Squeezer, TakesSmallerStepsWithTheUpdateOfCayley) {
  const CaseScene s = squeezer();
  const auto error = [&](double h) {
    SchemeOptions options = mechanism_options(h);
    options.update = GroupUpdate::cayley;
    return largest_error(s, run_scene(s, "passive_midpoint", options, kEnd));
  };
  const double coarse = error(1e-5), fine = error(8e-6);
  EXPECT_GT(coarse, 1e-4);
  EXPECT_LT(fine, 1e-4);
}

TEST(Squeezer, EndsThereToEightDigitsByTheEventDrivenReference) {
  const CaseScene s = squeezer();
  EXPECT_LT(largest_error(s, run_scene(s, "event_driven", mechanism_options(1e-2), kEnd)), 1e-7);
}

// Of the spring, the bodies and the motor together: what the motor did is its torque times the angle.
TEST(Squeezer, KeepsTheEnergyThatItsMotorGives) {
  const CaseScene s = squeezer();
  const auto lost = [&](double h) {
    const double before = energy(s.model, s.state).total();
    double worst = 0;
    run_scene(s, "moreau_jean", mechanism_options(h), kEnd, [&](const State& now, const StepReport&) {
      const double given = 0.033 * joint_coordinate(s.model, now, 0);
      worst = std::max(worst, std::abs(energy(s.model, now).total() - before - given));
    });
    return worst;
  };
  const double coarse = lost(3e-5), fine = lost(1e-5);
  EXPECT_LT(fine, 1e-5);
  EXPECT_GT(std::log(coarse / fine) / std::log(3), 1.8);
}

}  // namespace
}  // namespace aussois
