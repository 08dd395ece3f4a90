// SPDX-License-Identifier: Apache-2.0
// What a step remembers of the one before makes it faster and changes no bit: along assembly paths, a scheme
// that is made anew for every step moves the part alike.
#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_scene.hpp"
#include "tests/integration/recorded_pair.hpp"

namespace aussois {
namespace {

struct Stretch {
  const char* pair;
  double stride;  // of a step, in dilations: where it is short, much is kept
  int steps;
};

class Coherence : public ::testing::TestWithParam<Stretch> {};

TEST_P(Coherence, OfStepsChangesNoBit) {
  const std::string pair = GetParam().pair;
  const std::optional<AssemblyInput> input = recorded_pair(pair);
  if (!input) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  const AssemblyScene scene = make_assembly_scene(*input, {.stride = GetParam().stride}, 1);
  const StepOptions options{.h = scene.h};
  const MoreauJean scheme(scene.model, options, {.theta = 1});
  State with = start_of(scene), without = with;
  int remembered = 0;  // steps that could use what was kept
  for (int k = 0; k < GetParam().steps; ++k) {
    const StepReport a = scheme.step(with, scene.h),
                     b = MoreauJean(scene.model, options, {.theta = 1}).step(without, scene.h);
    ASSERT_EQ(hash(with), hash(without)) << "step " << k;
    ASSERT_EQ(a.min_gap, b.min_gap) << "step " << k;
    ASSERT_EQ(a.min_base_distance, b.min_base_distance) << "step " << k;
    ASSERT_EQ(a.solve.residual, b.solve.residual) << "step " << k;
    ASSERT_EQ(a.contacts_found, b.contacts_found) << "step " << k;
    remembered += a.kept_bytes > b.kept_bytes;
  }
  EXPECT_GT(remembered, 0);
}
// Of each the beginning, where the part comes to lie on the other.
INSTANTIATE_TEST_SUITE_P(Pairs, Coherence,
                         ::testing::Values(Stretch{"peg_in_socket", 4, 400}, Stretch{"press_p1p2", 0.1, 250},
                                           Stretch{"factory_peg_round_loose", 0.1, 250}),
                         [](const auto& instance) { return std::string(instance.param.pair); });

}  // namespace
}  // namespace aussois
