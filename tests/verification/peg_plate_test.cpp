// SPDX-License-Identifier: Apache-2.0
// The acceptance of the peg-and-plate study (PEG-17) over five seeds of few cases, so that it runs in a
// minute of one core. All of it, 100 and 125 cases: integration.PegPlate.five_seeds_meet_all, label long.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "examples/studies/peg_plate/study.hpp"

namespace aussois {
namespace {

constexpr std::uint64_t kSeeds[] = {1, 2, 3, 4, 5};

// What the verdicts judge and no more: the network of one kind of labels, no oracle; the reference with steps
// of 50 instead of 20 microseconds. What needs no training is scored on all cases: on the few that the
// network is tested on, the chance of a single one decides between kmc and kmcw.
PegResult thin_study(const std::string& name, LabelMode mode, int count, int leans, std::uint64_t seed) {
  const PegSet set = *std::ranges::find(peg_sets(), name, &PegSet::name);
  const PegStudyOptions options =
      options_for(set, {.plant = {.step = 5e-5, .count = count, .leans = leans, .seed = seed},
                        .training = {.seed = seed},
                        .static_stride = set.scenario == PegScenario::surface ? 15 : 5,
                        .moving_stride = set.scenario == PegScenario::surface ? 20 : 10,
                        .threads = 2});
  const PegData data = generate(options);
  const PegSplit split = split_cases(options);
  const Lessons lessons = make_lessons(data, split, options);
  PegResult out{.set = name, .seed = seed, .upright_share = learnt_from(lessons, set.scenario).upright_share};
  std::vector<int> all(data.size());
  std::iota(all.begin(), all.end(), 0);
  for (const NamedMethod& method : untrained_methods(set.scenario, options.view, seed))
    out.scores.push_back(score(method, data, all, options));
  const NamedMethod learned = learned_method(std::string("mlc_") + to_string(mode), set.scenario,
                                             train(lessons, mode, options).network);
  out.scores.push_back(score(learned, data, split.test, options));
  return out;
}

std::vector<PegResult> five_seeds(const std::string& name, LabelMode mode, int count, int leans = 1) {
  std::vector<PegResult> out;
  for (const std::uint64_t seed : kSeeds) out.push_back(thin_study(name, mode, count, leans, seed));
  return out;
}

// All lines of the verdict, as many as they are.
void expect_accepted(const std::vector<PegResult>& results, const std::vector<TrainingCheck>& checks,
                     std::size_t lines) {
  const std::vector<PegVerdict> all = verdicts(results, checks);
  EXPECT_EQ(all.size(), lines);
  for (const PegVerdict& v : all)
    EXPECT_TRUE(v.accepted()) << v.what << ": " << v.value << " against " << v.bound;
  std::printf("%s%s", score_table(results).c_str(), to_string(all).c_str());
}

TEST(PegPlateStudy, A1_A4_HullsAndNetworksCarryAPegOnASlightlyTiltedPlate) {
  expect_accepted(five_seeds("surface_0.1", LabelMode::ranked, 4), {}, 8);
}

TEST(PegPlateStudy, A1_A4_HullsAndNetworksCarryATiltedPegAndMeansOfClustersDoNot) {
  expect_accepted(five_seeds("surface_0.3", LabelMode::ranked, 4), {}, 8);
}

TEST(PegPlateStudy, A2_OnAnEdgeALearnedNormalIsBetterThanTheUprightOne) {
  for (const char* set : {"edge_0.1", "edge_0.3"})
    expect_accepted(five_seeds(set, LabelMode::soft, 3, 3), {}, 3);
}

TEST(PegPlateStudy, A3_OnATruePlateEveryChoiceCarries) {
  expect_accepted({thin_study("surface_0", LabelMode::ranked, 3, 1, 1)}, {}, 5);
}

TEST(PegPlateStudy, A5_TrainingHasItsGradientItsBitsAndItsLoss) {
  std::vector<TrainingCheck> checks;
  for (const std::uint64_t seed : kSeeds) checks.push_back(check_training(seed));
  expect_accepted({}, checks, 3);
}

}  // namespace
}  // namespace aussois
