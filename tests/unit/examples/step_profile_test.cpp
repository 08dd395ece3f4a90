// SPDX-License-Identifier: Apache-2.0
#include "examples/common/step_profile.hpp"

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

TEST(StepProfile, GivesQuantilesByNearestRank) {
  StepProfile profile;
  for (int k = 1; k <= 200; ++k) {  // ms, in no order
    StepReport report;
    report.stages[Stage::solve] = {1e-3 * (k * 7 % 201), 2e-3 * k};
    report.total = {0.3, 0.5};
    profile.add(report, {0.001, 0});
  }
  EXPECT_EQ(profile.steps(), 200U);
  const std::vector<StageFigures> figures = profile.figures();
  ASSERT_EQ(figures.size(), std::size(kStages) + 3);
  const StageFigures& solve = figures[std::size_t(Stage::solve)];
  EXPECT_EQ(solve.stage, "solve");
  EXPECT_NEAR(solve.p50, 100, 1e-9);
  EXPECT_NEAR(solve.p99, 198, 1e-9);
  EXPECT_NEAR(solve.most, 200, 1e-9);
  EXPECT_NEAR(solve.mean, 100.5, 1e-9);
  EXPECT_NEAR(solve.cpu_p99, 396, 1e-9);
  EXPECT_EQ(figures[std::size(kStages)].stage, "other");
  EXPECT_NEAR(figures[std::size(kStages)].most, 299, 1e-9);
  EXPECT_NEAR(figures[std::size(kStages) + 1].p50, 1, 1e-12);  // recording
  EXPECT_NEAR(figures[std::size(kStages) + 2].p50, 300, 1e-9);
}

TEST(StepProfile, OfMoreStepsThanItKeepsHasTheMeanAndTheLargestOfAll) {
  StepProfile profile;
  const int steps = 3 * int(StepProfile::kMostSteps);
  for (int k = 1; k <= steps; ++k) {
    StepReport report;
    report.stages[Stage::solve] = {1e-3 * (k == 4 ? 2 * steps : k), 0};  // the fourth is among those left out
    profile.add(report);
  }
  EXPECT_EQ(profile.steps(), std::size_t(steps));
  const StageFigures solve = profile.figures()[std::size_t(Stage::solve)];
  EXPECT_NEAR(solve.most, 2.0 * steps, 1e-6);
  EXPECT_NEAR(solve.mean, (steps + 1) / 2.0 + (2.0 * steps - 4) / steps, 1e-6 * steps);
  EXPECT_NEAR(solve.p50, steps / 2.0, 4);  // of every fourth
}

TEST(SharedProfile, AddsUpStepsOfSeveralThreads) {
  SharedProfile shared;
  parallel_for(40, 4, [&](int i) {
    StepReport report;
    report.total.wall = 1e-3 * (i + 1);
    shared.add(report);
  });
  EXPECT_EQ(shared.all().steps(), 40U);
  EXPECT_NEAR(shared.all().figures().back().most, 40, 1e-9);
}

TEST(StepProfile, SetsAListPerFigureAndNothingWithoutSteps) {
  Summary summary;
  set_profile(StepProfile(), summary);
  EXPECT_TRUE(summary.entries.empty());
  StepProfile profile;
  profile.add({.kept_bytes = 700});
  profile.add({});
  set_profile(profile, summary);
  ASSERT_EQ(summary.entries.size(), 10U);
  EXPECT_EQ(summary.entries[9].first, "profile_kept_bytes");
  EXPECT_EQ(std::get<std::int64_t>(summary.entries[9].second), 700);
  EXPECT_EQ(summary.entries[0].first, "profile_stages");
  EXPECT_EQ(std::get<std::vector<std::string>>(summary.entries[0].second).back(), "step");
  EXPECT_EQ(summary.entries[2].first, "profile_wall_ms_p99");
  EXPECT_EQ(std::get<std::vector<double>>(summary.entries[2].second).size(), std::size(kStages) + 3);
}

// The stages of all attempts are parts of the step, and CPU times are taken only if asked for. The motion is
// the same.
TEST(StepProfile, OfAStepIsOfItsParts) {
  Scene s = block_on_plate(0.3, 0, 0);
  State other = s.state;
  const MoreauJean plain(s.model, {.h = 1e-3}), timed(s.model, {.h = 1e-3, .profile = true});
  for (int k = 0; k < 5; ++k) {
    const StepReport without = plain.step(s.state), with = timed.step(other);
    double wall = 0, cpu = 0;
    for (const StageTime& stage : with.stages.of) wall += stage.wall, cpu += stage.cpu;
    EXPECT_GT(wall, 0);
    EXPECT_LE(wall, with.total.wall);
    EXPECT_LE(cpu, with.total.cpu);
    EXPECT_EQ(without.total.cpu, 0);
    EXPECT_GT(without.stages[Stage::search].wall, 0);
    EXPECT_EQ(hash(s.state), hash(other));
  }
}

}  // namespace
}  // namespace aussois
