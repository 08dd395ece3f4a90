// SPDX-License-Identifier: Apache-2.0
// The acceptance of the peg-and-plate study (PEG-17), smaller and of one seed so that it runs in a minute.
// All of it, five seeds of 100 and 125 cases: integration.PegPlate.five_seeds_meet_all_that_needs_no_ranking,
// label long.
#include <algorithm>

#include <gtest/gtest.h>

#include "examples/peg_plate/study.hpp"

namespace aussois {
namespace {

PegResult reduced(const std::string& name, int count, int leans) {
  const PegSet set = *std::ranges::find(peg_sets(), name, &PegSet::name);
  PegStudyOptions options{.plant = {.count = count, .leans = leans}, .training = {.iterations = 200}};
  return run_study(set, options);
}

void expect_accepted(const std::vector<PegResult>& results, std::size_t lines) {
  const std::vector<PegVerdict> all = verdicts(results);
  EXPECT_EQ(all.size(), lines);  // none is left out
  for (const PegVerdict& v : all)
    EXPECT_TRUE(v.accepted()) << v.what << ": " << v.value << " against " << v.bound;
  std::printf("%s%s", score_table(results).c_str(), to_string(all).c_str());
}

TEST(PegPlateStudy, A1_A4_HullsCarryATiltedPegAndMeansOfClustersDoNot) {
  expect_accepted({reduced("surface_0.3", 4, 1)}, 8);
}

TEST(PegPlateStudy, A3_OnATruePlateEveryChoiceCarries) {
  expect_accepted({reduced("surface_0", 3, 1)}, 5);
}

TEST(PegPlateStudy, A2_OnAnEdgeALearnedNormalIsBetterThanTheUprightOne) {
  expect_accepted({reduced("edge_0.1", 3, 4)}, 3);
}

}  // namespace
}  // namespace aussois
