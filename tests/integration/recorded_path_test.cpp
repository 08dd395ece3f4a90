// SPDX-License-Identifier: Apache-2.0
// Along recorded assembly paths the hierarchical search finds what looking at every pair of leaves finds: the
// same features, the same bits.
#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_scene.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/integration/recorded_pair.hpp"

namespace aussois {
namespace {

class RecordedPath : public ::testing::TestWithParam<const char*> {};

TEST_P(RecordedPath, HasTheContactsOfTheExhaustiveSearch) {
  const std::string pair = GetParam();
  const std::optional<AssemblyInput> input = recorded_pair(pair);
  if (!input) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  const AssemblyScene scene = make_assembly_scene(*input, {}, 2);
  const auto posed = [&](BodyId body, const SE3& g_wb) {
    const RigidBody& b = scene.model.bodies[body];
    return PosedShape{scene.model.shapes[b.shape].get(), g_wb * b.g_bs, body};
  };
  const LmdOptions options{.threshold = 2 * scene.clearance, .threads = 2};
  const std::size_t stride = pair == "alpha15" ? 3 : 1;  // all pairs of 8320 triangles take a second a pose
  std::size_t poses_in_contact = 0;
  for (std::size_t k = 0; k < scene.poses.size(); k += stride) {
    const PosedShape fixed = posed(scene.fixed, {}), moving = posed(scene.moving, scene.poses[k]);
    const ContactSet fast = find_contacts(fixed, moving, options);
    const ContactSet slow = find_contacts_exhaustive(fixed, moving, options);
    ASSERT_EQ(fast.points.size(), slow.points.size()) << "pose " << k;
    for (std::size_t i = 0; i < slow.points.size(); ++i) {
      ASSERT_EQ(key_of(fast.points[i]), key_of(slow.points[i])) << "pose " << k << " contact " << i;
      ASSERT_EQ(fast.points[i].gap, slow.points[i].gap) << "pose " << k << " contact " << i;
      ASSERT_EQ(fast.points[i].x_a, slow.points[i].x_a) << "pose " << k << " contact " << i;
      ASSERT_EQ(fast.points[i].normal, slow.points[i].normal) << "pose " << k << " contact " << i;
    }
    poses_in_contact += !slow.points.empty();
  }
  // The clearance is that of some pose, so contacts within twice of it are there; and not only once.
  EXPECT_GT(poses_in_contact, stride == 1 ? 2U : 1U);
}
// All pairs with at most 5000 triangles a side; those of the slow test take seconds to minutes each.
#ifdef AUSSOIS_SLOW_PAIRS
const auto kPairs = ::testing::Values("alpha15", "alpha20", "factory_peg_round_loose", "piston_head",
                                      "press_p3p4", "screw_387266");
#else
const auto kPairs =
    ::testing::Values("peg_in_socket", "own_tslot", "press_p1p2", "gear_mesh", "box_finger", "piston_crank");
#endif
INSTANTIATE_TEST_SUITE_P(Pairs, RecordedPath, kPairs,
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace aussois
