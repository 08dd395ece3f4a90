// SPDX-License-Identifier: Apache-2.0
// The reserve (PORT-3), (PORT-4): whatever forces are wished for, no window of time gives more than was
// stored at its start and is lent.
#include "ports/reserve.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/so3.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// A handle that goes anywhere within its accelerations, read through encoders, and wishes that have nothing
// to do with it. The work of torques is that of the turns that it really makes.
TEST(Reserve, BoundsWhatLeavesFromAnyStepOn) {
  Random random(11);
  const ReserveOptions o{.lend = 5e-3, .count = 1e-5, .rotation_count = 0};
  const double T = o.period;
  std::int64_t scaled = 0;
  double most = 0;
  for (int run = 0; run < 50; ++run) {
    Vec3 v = Vec3::Zero(), spin = Vec3::Zero();
    SE3 handle, seen;
    DeviceForce held;
    Reserve reserve{.level = o.lend};
    double left = 0, lowest = kInf, worst = 0, stored = 0, counted = 0;
    for (int k = 0; k < 3000; ++k) {
      // A change of half the bound in each half of a period: that of a second difference is at most the bound
      const Vec3 dv = 0.5 * o.acceleration * T * random.vector_of_length(1, 1),
                 dw = 0.5 * o.rotation * T * random.vector_of_length(1, 1);
      for (int half = 0; half < 2; ++half) {
        v = 0.99 * v + dv / 2, spin = 0.99 * spin + dw / 2;
        handle = {(exp_so3(T / 2 * spin) * handle.R).normalized(), handle.p + T / 2 * v};
        left += held.torque.dot(T / 2 * spin);
      }
      SE3 sample = handle;
      for (int i = 0; i < 3; ++i) sample.p[i] = o.count * std::round(handle.p[i] / o.count);
      const DeviceMotion motion = motion_between(seen, sample);
      left += held.force.dot(sample.p - seen.p);
      seen = sample;
      const double work = work_left(held, motion, o);
      counted += work;
      EXPECT_GE(counted, left - 1e-12);  // nothing is missed
      reserve = after_sample(reserve, work);
      worst = std::max(worst, left - lowest);
      if (k % 5 == 0) {  // bodies that are given, and lose, as it comes
        stored = std::max(0.0, stored + random.uniform(-2e-3, 2e-3));
        reserve = after_tick(reserve, stored, o);
        lowest = std::min(lowest, left + stored);
      }
      const Valve valve =
          let_through(DeviceForce{40 * random.vector_of_length(1, 1), 2 * random.vector_of_length(1, 1)},
                      motion, reserve, o);
      held = valve.force, reserve = valve.reserve;
    }
    EXPECT_LE(worst, o.lend + 1e-12);
    EXPECT_EQ(reserve.negative, 0);
    most = std::max(most, worst), scaled += reserve.scaled;
  }
  EXPECT_GT(most, 0.5 * o.lend);  // they take what they can get
  EXPECT_GT(scaled, 1000);
}

TEST(Reserve, LetsThroughWhatItCanPay) {
  const ReserveOptions o;
  const DeviceForce wish{{10, 0, 0}, Vec3::Zero()};
  const DeviceMotion away{{-1e-3, 0, 0}, Vec3::Zero()}, along{{1e-3, 0, 0}, Vec3::Zero()};
  EXPECT_EQ(let_through(wish, away, {.level = 0}, o).force.force, wish.force);  // the hand works
  EXPECT_EQ(let_through(wish, along, {.level = 1}, o).force.force, wish.force);
  const double leave = 10 * 1e-3 + 10 * (o.acceleration * 1e-6 + 2 * o.count);  // (PORT-4)
  const Valve half = let_through(wish, along, {.level = leave / 2}, o);
  EXPECT_NEAR(half.force.force.x(), 5, 1e-12);
  EXPECT_EQ(half.reserve.scaled, 1);
  const Valve none = let_through(wish, along, {.level = -1e-6}, o);
  EXPECT_EQ(none.force.force, Vec3(Vec3::Zero()));
  EXPECT_EQ(none.reserve.stopped, 1);
}

TEST(Reserve, PassesNothingThatIsNoNumber) {
  const ReserveOptions o;
  const double nan = std::nan("");
  EXPECT_EQ(let_through({{nan, 0, 0}, Vec3::Zero()}, {}, {.level = 1}, o).force.force, Vec3(Vec3::Zero()));
  const Valve none = let_through({{1, 0, 0}, Vec3::Zero()}, {}, after_sample({.level = 1}, nan), o);
  EXPECT_EQ(none.force.force, Vec3(Vec3::Zero()));
  EXPECT_EQ(none.reserve.refused, 1);
}

TEST(Reserve, RefusesOptionsOutOfRange) {
  expect_names(message_of([] { validate(ReserveOptions{.period = 0}); }), "period = 0");
  expect_names(message_of([] { validate(ReserveOptions{.lend = -1}); }), "lend = -1");
}

}  // namespace
}  // namespace aussois
