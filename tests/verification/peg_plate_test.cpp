// SPDX-License-Identifier: Apache-2.0
// The acceptance of the peg-and-plate study (PEG-17) on few cases, so that it runs in a minute. All of it,
// five seeds of 100 and 125 cases: integration.PegPlate.five_seeds_meet_all, label long.
#include <algorithm>

#include <gtest/gtest.h>

#include "examples/peg_plate/study.hpp"

namespace aussois {
namespace {

PegResult reduced(const std::string& name, int count, int leans, std::uint64_t seed = 1) {
  const PegSet set = *std::ranges::find(peg_sets(), name, &PegSet::name);
  return run_study(
      set,
      {.plant = {.count = count, .leans = leans, .seed = seed}, .static_stride = 15, .moving_stride = 20});
}

// All lines of the verdict, as many as they are, but those that begin with `but`.
void expect_accepted(const std::vector<PegResult>& results, std::size_t lines, const std::string& but = "-") {
  const std::vector<PegVerdict> all = verdicts(results);
  EXPECT_EQ(all.size(), lines);
  for (const PegVerdict& v : all)
    EXPECT_TRUE(v.accepted() || v.what.starts_with(but))
        << v.what << ": " << v.value << " against " << v.bound;
  std::printf("%s%s", score_table(results).c_str(), to_string(all).c_str());
}

// Of five test cases per seed, what kmc and kmcw lose differs by chance; over all seeds it does not.
void expect_equally_wrong(const std::vector<PegResult>& results) {
  double kmc = 0, kmcw = 0;
  for (const PegResult& result : results)
    for (const PegScore& score : result.scores) {
      if (score.name == "kmc") kmc += score.still_size;
      if (score.name == "kmcw") kmcw += score.still_size;
    }
  EXPECT_GT(kmcw, 5 * 0.03);
  EXPECT_GE(kmc / kmcw, 0.75);
  EXPECT_LE(kmc / kmcw, 1.33);
}

TEST(PegPlateStudy, A1_A4_HullsAndNetworksCarryATiltedPegAndMeansOfClustersDoNot) {
  std::vector<PegResult> results;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) results.push_back(reduced("surface_0.3", 4, 1, seed));
  expect_accepted(results, 8, "A-1 kmc / kmcw");
  expect_equally_wrong(results);
}

TEST(PegPlateStudy, A3_OnATruePlateEveryChoiceCarries) {
  expect_accepted({reduced("surface_0", 3, 1)}, 5);
}

TEST(PegPlateStudy, A2_OnAnEdgeALearnedNormalIsBetterThanTheUprightOne) {
  expect_accepted({reduced("edge_0.1", 3, 4)}, 3);
}

}  // namespace
}  // namespace aussois
