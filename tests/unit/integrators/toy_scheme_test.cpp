// SPDX-License-Identifier: Apache-2.0
// A scheme is two functions: all else, from the search to the ledgers, is there.
#include "tests/support/toy_scheme.hpp"

#include "integrators/prove/path_audit.hpp"
#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

// Moreau-Jean at theta = 1 with the gap over the step is the same scheme by another road.
TEST(ToyScheme, StepsAsMoreauJeanDoesAtThetaOne) {
  Scene scene = block_on_plate(0.4, 0, 0, 0.02);
  linear_part(scene.state.v, scene.block) = Vec3(0.8, 0.1, 0);
  angular_part(scene.state.v, scene.block) = Vec3(0.2, 3, 0.5);
  const ToyScheme toy(scene.model, {.h = 2e-3});
  const MoreauJean known(scene.model, {.h = 2e-3}, {.theta = 1, .law = NormalLaw::gap_over_step});
  State a = scene.state, b = scene.state;
  PathAudit audit{.samples = 3};
  bool touched = false;
  for (int k = 0; k < 150; ++k) {
    const State start = a;
    const StepReport by_toy = toy.step(a), by_known = known.step(b);
    ASSERT_TRUE(by_toy.ok()) << by_toy.reason;
    ASSERT_EQ(hash(a), hash(b)) << "step " << k;
    EXPECT_EQ(by_toy.energy.contact_work, by_known.energy.contact_work);
    EXPECT_LT(std::abs(by_toy.energy.residual()), 1e-12);
    touched = touched || by_toy.energy.contact_work < 0;
    audit_path(scene.model, start, a, by_toy, 1, audit);
  }
  EXPECT_TRUE(touched);
  EXPECT_EQ(audit.violations, 0);
}

}  // namespace
}  // namespace aussois
