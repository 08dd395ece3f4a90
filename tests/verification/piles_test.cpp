// SPDX-License-Identifier: Apache-2.0
// What rests stays, in every scheme and setting: bodies that fall alike and stand on each other (G1, G3, G4).
#include <algorithm>

#include <gtest/gtest.h>

#include "examples/scenes/library.hpp"
#include "integrators/scheme.hpp"

namespace aussois {
namespace {

class EveryPile : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryPile, StandsInEveryScheme) {
  const LibraryScene& pile = library_scene(GetParam());
  const CaseScene scene = pile.make();
  const bool large = scene.model.bodies.size() > 150;  // three steps of each scheme's first setting do
  std::string last;
  for (SchemeVariant variant : scheme_variants()) {
    if (large && variant.name == last) continue;
    last = variant.name;
    variant.options.h = pile.h;
    const Scheme scheme = make_scheme(variant.name, scene.model, variant.options);
    State state = scene.state;
    const double before = energy(scene.model, state).total();
    for (int k = 0; k < (large ? 3 : 8); ++k) {
      const StepReport report = scheme.step(state, pile.h);
      ASSERT_TRUE(report.ok()) << label(variant.name, variant.options) << ": " << report.reason;
      EXPECT_EQ(report.attempts, 1) << label(variant.name, variant.options);
    }
    double moved = 0;
    for (std::size_t b = 0; b < state.g.size(); ++b)
      moved = std::max(moved, (state.g[b].p - scene.state.g[b].p).norm());
    EXPECT_LT(moved, 1e-9) << label(variant.name, variant.options);
    EXPECT_NEAR(energy(scene.model, state).total(), before, 1e-10 * before)
        << label(variant.name, variant.options);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryPile,
                         ::testing::Values("bead_column", "tower", "heavy_tower", "arch", "kapla"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace aussois
