// SPDX-License-Identifier: Apache-2.0
#include "lmd/broad_phase.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

using IndexPairs = std::vector<std::pair<int, int>>;
using Boxes = std::vector<DilatedBox>;

DilatedBox ball(const Vec3& centre, double radius) {
  return {.centre = centre, .radius = radius};
}

DilatedBox random_box(Random& random, double spread, const Vec3& half, double radius) {
  return SE3{random.rotation(), random.vector(spread)} * DilatedBox{.half = half, .radius = radius};
}

// Distance of two undilated boxes by alternating projections, which converge to a closest pair from outside.
double distance_by_projections(const DilatedBox& a, const DilatedBox& b, int rounds) {
  const auto nearest = [](const DilatedBox& box, const Vec3& x) {
    const Vec3 local = box.axes.transpose() * (x - box.centre);
    return Vec3(box.centre + box.axes * local.cwiseMax(-box.half).cwiseMin(box.half));
  };
  Vec3 x = a.centre, y = b.centre;
  for (int i = 0; i < rounds; ++i) x = nearest(a, y), y = nearest(b, x);
  return (x - y).norm();
}

TEST(Separation, IsBelowTheDistanceAndPositiveForDisjointBoxes) {
  Random random(1);
  int apart = 0, overlapping = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const auto half = [&] { return Vec3{random.uniform(), random.uniform(0, 0.1), random.uniform()}; };
    const DilatedBox a = random_box(random, 1, half(), 0), b = random_box(random, 1, half(), 0);
    const double bound = separation(a, b), distance = distance_by_projections(a, b, 3000);
    EXPECT_LE(bound, distance + 1e-12) << sample;
    EXPECT_TRUE(distance < 1e-3 || bound > 0) << sample;  // the 15 axes are all that two boxes need
    ++(distance > 1e-3 ? apart : overlapping);
    DilatedBox inflated_a = a, inflated_b = b;
    inflated_a.radius = 0.125, inflated_b.radius = 0.25;
    if (bound > 0.5) {
      EXPECT_NEAR(separation(inflated_a, inflated_b), bound - 0.375, 1e-12) << sample;
    }
  }
  EXPECT_GT(apart, 300);
  EXPECT_GT(overlapping, 300);
}

TEST(Separation, OfBallsIsTheirDistance) {
  EXPECT_NEAR(separation(ball({1, 2, 3}, 0.5), ball({4, 6, 3}, 1)), 3.5, 1e-12);
  EXPECT_LT(separation(ball({0, 0, 0}, 1), ball({2, 0, 0}, 1)), 1e-12);
}

TEST(BoxAround, HoldsItsPointsAndFollowsASlantedRod) {
  Random random(2);
  for (int sample = 0; sample < 50; ++sample) {
    const SE3 g = random.pose(1);
    std::vector<Vec3> points;
    for (int i = 0; i < 30; ++i)
      points.push_back(g *
                       Vec3{random.uniform(-1, 1), random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05)});
    const DilatedBox box = box_around(points);
    for (const Vec3& x : points)
      EXPECT_TRUE(
          ((box.axes.transpose() * (x - box.centre)).cwiseAbs().array() <= box.half.array() + 1e-12).all());
    EXPECT_LT(box.half.minCoeff(), 0.1) << sample;
    EXPECT_LT((box.axes.transpose() * box.axes - Mat3::Identity()).norm(), 1e-12);
  }
  EXPECT_EQ(box_around(std::array{Vec3(1, 2, 3)}).half, Vec3::Zero());
}

IndexPairs all_pairs(const Boxes& boxes) {
  IndexPairs pairs;
  for (int i = 0; i < int(boxes.size()); ++i)
    for (int j = i + 1; j < int(boxes.size()); ++j) {
      const DilatedBox &a = boxes[i], &b = boxes[j];
      if (!(a.fixed && b.fixed) && !(separation(a, b) > 0)) pairs.emplace_back(i, j);
    }
  return pairs;
}

// Scenes by name and size, at constant packing where that has a meaning.
Boxes scene(const std::string& name, int n, Random& random) {
  Boxes boxes;
  const double side = std::cbrt(double(n));
  if (name == "balls")
    for (int i = 0; i < n; ++i) boxes.push_back(ball(random.vector(side / 2), 0.6));
  if (name == "all sizes")
    for (int i = 0; i < n; ++i) {
      const double size = random.log_uniform(1e-3, 2);
      boxes.push_back(random_box(random, side / 2, size * Vec3(1, 0.5, 0.2), 0.1 * size));
    }
  if (name == "pebbles on a plate") {
    for (int i = 0; i < n; ++i)
      boxes.push_back(
          ball({random.uniform(0, side), random.uniform(0, side), random.uniform(0.4, side)}, 0.5));
    boxes[n / 3] = {.half = {2 * side, 2 * side, 0}, .radius = 1e-3, .fixed = true};
  }
  if (name == "shelves")  // plates as wide as the scene, pebbles between them
    for (int i = 0; i < n; ++i) {
      const double floor = 3 * random.index(n / 10);
      boxes.push_back({.centre = {random.uniform(-1, 1), random.uniform(-1, 1), floor + 1}, .radius = 0.3});
      if (i % 10 == 0) boxes.back() = {.centre = {0, 0, 0.3 * i}, .half = {2, 2, 0.1}};
    }
  if (name == "slanted rods")
    for (int i = 0; i < n; ++i) boxes.push_back(random_box(random, side, {5, 0.02, 0.02}, 0.02));
  if (name == "clump")  // ever denser towards one place, ever smaller
    for (int i = 0; i < n; ++i) {
      const double distance = random.log_uniform(1e-12, 1);
      boxes.push_back(ball(distance * random.direction(), 2.5 * distance / side));
    }
  if (name == "one place")
    for (int i = 0; i < n; ++i) boxes.push_back(random_box(random, 0, {1, 1, 1}, 0));
  if (name == "everywhere")
    for (int i = 0; i < n; ++i) boxes.push_back(ball(random.vector_of_log_length(1e-100, 1e100), 1));
  if (name == "mostly fixed") {
    for (int i = 0; i < n; ++i) boxes.push_back(random_box(random, 1, {0.5, 0.5, 0.5}, 0));
    for (int i = 3; i < n; ++i) boxes[i].fixed = true;
  }
  if (name == "line")
    for (int i = 0; i < n; ++i) boxes.push_back(ball({0.9 * i, 0, 0}, 0.5));
  return boxes;
}

class BroadPhaseScene : public ::testing::TestWithParam<const char*> {};

TEST_P(BroadPhaseScene, FindsExactlyThePairsThatMeetForAnyNumberOfThreads) {
  Random random(7);
  std::size_t pairs = 0;
  for (const int n : {20, 100, 400}) {
    const Boxes boxes = scene(GetParam(), n, random);
    const IndexPairs expected = all_pairs(boxes);
    for (const int threads : {1, 2, 3, 5}) EXPECT_EQ(broad_phase(boxes, threads), expected) << n;
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 20U);
}

// A crowd that drifts, turns and breathes, with a leap now and then; rooms last for some steps of the drift.
TEST_P(BroadPhaseScene, FindsTheSamePairsWithWhatItKeptOfTheLastStep) {
  Random random(9);
  int steps = 0, kept = 0;
  for (const int n : {20, 200}) {
    Boxes boxes = scene(GetParam(), n, random);
    BroadPhaseScratch scratch;
    for (int step = 0; step < 60; ++step, ++steps) {
      const std::vector<StraightBox> before = scratch.room;
      EXPECT_EQ(broad_phase(boxes, 1 + step % 3, scratch), broad_phase(boxes)) << n << ", " << step;
      kept += !before.empty() && before[0].lo == scratch.room[0].lo && before[0].hi == scratch.room[0].hi;
      if (step == 40) boxes[0].fixed = !boxes[0].fixed;
      const double pace = step % 20 == 19 ? 1 : 1e-3;
      for (DilatedBox& box : boxes) {
        const double size = box.half.norm() + box.radius;
        const SE3 turn{exp_so3(random.vector_of_length(0, pace)), Vec3::Zero()};
        box.axes = turn.R.toRotationMatrix() * box.axes;
        box.centre += pace * size * random.direction();
        box.radius *= random.uniform(1 - pace / 2, 1 + pace / 2);
      }
    }
    boxes.push_back(boxes.front());
    EXPECT_EQ(broad_phase(boxes, 1, scratch), broad_phase(boxes)) << "one more";
  }
  std::printf("%s: %d of %d steps kept their rooms\n", GetParam(), kept, steps);
  EXPECT_GT(kept, steps / 4);
  EXPECT_LT(kept, steps);
}

class BroadPhaseGrowth : public ::testing::TestWithParam<const char*> {};

// Counted, not timed: what is looked at per n log n + pairs does not grow with n.
TEST_P(BroadPhaseGrowth, HasNoQuadraticStep) {
  const std::string name = GetParam();
  double first = 0;
  for (const int n : {500, 4000, 32000}) {
    Random random(8);
    const Boxes boxes = scene(name, n, random);
    BroadPhaseStatistics count;
    const IndexPairs pairs = broad_phase(boxes, 2, &count);
    const double work =
        double(count.node_pairs + count.box_pairs) / (n * std::log2(n) + double(pairs.size()));
    std::printf("%s, %d: %.1f pairs per body, work %.2f\n", name.c_str(), n, double(pairs.size()) / n, work);
    if (first == 0) first = work;
    EXPECT_LT(work, 1.5 * first + 0.5) << n;
    EXPECT_LT(work, 30) << n;  // slanted rods come near it: straight boxes around them overlap
  }
}

std::string without_spaces(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, BroadPhaseScene,
                         ::testing::Values("balls", "all sizes", "pebbles on a plate", "shelves",
                                           "slanted rods", "clump", "one place", "everywhere", "mostly fixed",
                                           "line"),
                         [](const auto& scene_of) { return without_spaces(scene_of.param); });
// Without those where a constant part of all pairs meet.
INSTANTIATE_TEST_SUITE_P(Scenes, BroadPhaseGrowth,
                         ::testing::Values("balls", "all sizes", "pebbles on a plate", "shelves",
                                           "slanted rods", "clump", "line"),
                         [](const auto& scene_of) { return without_spaces(scene_of.param); });

TEST(BroadPhase, TakesWhatIsDegenerate) {
  EXPECT_TRUE(broad_phase({}).empty());
  EXPECT_TRUE(broad_phase({ball({0, 0, 0}, 1)}).empty());
  const Boxes unbounded{ball({0, 0, 0}, 1), ball({1e9, 0, 0}, kInf), ball({-5, 0, 0}, 1)};
  EXPECT_EQ(broad_phase(unbounded), (IndexPairs{{0, 1}, {1, 2}}));
  const Boxes points(9, ball({1, 1, 1}, 0));
  EXPECT_EQ(broad_phase(points).size(), 36U);  // touching counts
}

}  // namespace
}  // namespace aussois
