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

// A handle that goes anywhere within its acceleration, and wishes that have nothing to do with it.
TEST(Reserve, BoundsWhatLeavesInAnyWindowOfTime) {
  Random random(11);
  const ReserveOptions o{.lend = 5e-3, .count = 0, .rotation_count = 0};
  const double T = o.period;
  for (int run = 0; run < 50; ++run) {
    Vec3 v = Vec3::Zero(), spin = Vec3::Zero();
    SE3 handle;
    DeviceForce held;
    DeviceMotion motion;
    Reserve reserve{.level = o.lend};
    double left = 0, lowest = kInf, worst = 0, stored = 0;
    for (int k = 0; k < 3000; ++k) {
      v = 0.99 * v + 0.4 * o.acceleration * T * random.vector_of_length(1, 1);
      spin = 0.99 * spin + 0.4 * o.rotation * T * random.vector_of_length(1, 1);
      const SE3 next{(exp_so3(T * spin) * handle.R).normalized(), handle.p + T * v};
      const DeviceMotion before = std::exchange(motion, motion_between(handle, next));
      handle = next;
      const double work = work_left(held, motion, before);
      left += work;
      reserve = after_sample(reserve, work);
      EXPECT_GE(reserve.level, -1e-12);
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
    EXPECT_GT(worst, 0.5 * o.lend);  // they take what they can get
    EXPECT_GT(reserve.scaled, 100);
    EXPECT_EQ(reserve.negative, 0);
  }
}

TEST(Reserve, LetsThroughWhatItCanPay) {
  const ReserveOptions o;
  const DeviceForce wish{{10, 0, 0}, Vec3::Zero()};
  const DeviceMotion away{{-1e-3, 0, 0}, Vec3::Zero()}, along{{1e-3, 0, 0}, Vec3::Zero()};
  EXPECT_EQ(let_through(wish, away, {.level = 0}, o).force.force, wish.force);  // the hand works
  EXPECT_EQ(let_through(wish, along, {.level = 1}, o).force.force, wish.force);
  const double leave = 10 * 1e-3 + 10 * (o.acceleration * 1e-6 + 2 * o.count);
  const Valve half = let_through(wish, along, {.level = leave / 2}, o);
  EXPECT_NEAR(half.force.force.x(), 5, 1e-12);
  EXPECT_EQ(half.reserve.scaled, 1);
  const Valve none = let_through(wish, along, {.level = -1e-6}, o);
  EXPECT_EQ(none.force.force, Vec3(Vec3::Zero()));
  EXPECT_EQ(none.reserve.negative, 1);
}

// A turn of constant axis is counted exactly, one that changes its axis with what it may hide.
TEST(Reserve, CountsTheWorkOfTorques) {
  Random random(12);
  for (int k = 0; k < 100; ++k) {
    const SE3 from = random.pose(1);
    const Vec3 turn = random.vector(0.5);
    const SE3 to{(exp_so3(turn) * from.R).normalized(), from.p + random.vector(0.1)};
    const DeviceMotion motion = motion_between(from, to);
    EXPECT_LT((motion.turn - turn).norm(), 1e-13);
    const DeviceForce held{random.vector(3), random.vector(3)};
    EXPECT_NEAR(work_left(held, motion, motion), held.force.dot(to.p - from.p) + held.torque.dot(turn),
                1e-12);
    EXPECT_GE(work_left(held, motion, {}), work_left(held, motion, motion));
  }
}

TEST(Reserve, RefusesOptionsOutOfRange) {
  expect_names(message_of([] { validate(ReserveOptions{.period = 0}); }), "period = 0");
  expect_names(message_of([] { validate(ReserveOptions{.lend = -1}); }), "lend = -1");
}

}  // namespace
}  // namespace aussois
