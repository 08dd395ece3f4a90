// SPDX-License-Identifier: Apache-2.0
// Is a contact missing? On every pair and pose of the shared assemblies the smallest distance of the contacts
// must be that of the meshes: as the certificate finds it, and as FCL does, which knows nothing of cones,
// regions or classes.
#include <gtest/gtest.h>

#ifdef AUSSOIS_TEST_FCL
#include "bench/peer_fcl.hpp"
#endif
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/shared_pair.hpp"

namespace aussois {
namespace {

class Completeness : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::optional<AssemblyInput> pair = shared_pair(GetParam());
    if (!pair) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
    input = std::move(*pair);
    const Box& box = input.moving.report.box;
    part = box.diagonal();
    // Two dilations fit the tightest of the paths (4.2e-4 of this radius).
    dilation = 2e-4 * radius_about(input.moving.complex, (box.lo + box.hi) / 2);
    a = prepare({.complex = input.moving.complex, .radius = dilation});
    b = prepare({.complex = input.fixed.complex, .radius = dilation});
    ASSERT_FALSE(input.poses.empty());
  }

  // The smallest distance of contacts, looked for a little beyond `distance` [m]; infinite without any.
  double nearest(const SE3& g, double distance) const {
    const double threshold = 1.01 * distance - 2 * dilation;
    return smallest_gap(find_contacts({&a, g, 0}, {&b, {}, 1}, {.threshold = threshold})) + 2 * dilation;
  }

  AssemblyInput input;
  double part = 0, dilation = 0;  // [m]
  LmdShape a, b;
};

// To what regions and chains are off (doc/theory/lmd.md, Coverage).
TEST_P(Completeness, SmallestDistanceOfTheContactsIsThatOfTheBaseComplexes) {
  for (std::size_t i = 0; i < input.poses.size(); ++i) {
    const SE3& g = input.poses[i];
    const double distance = base_distance({&a, {}, {.g = g}}, {&b, {}, {}}, kInf);
    ASSERT_GT(distance, 2 * dilation) << "pose " << i;
    EXPECT_NEAR(nearest(g, distance), distance, coverage_tolerance({&a, g}, {&b})) << "pose " << i;
  }
}

TEST_P(Completeness, SmallestDistanceOfTheContactsIsThatOfTheMeshes) {
#ifdef AUSSOIS_TEST_FCL
  const FclPair fcl(input.moving.complex, input.fixed.complex);
  for (std::size_t i = 0; i < input.poses.size(); ++i) {
    const SE3& g = input.poses[i];
    const double distance = fcl.distance(g, {});
    ASSERT_GT(distance, 2 * dilation) << "pose " << i;
    EXPECT_NEAR(nearest(g, distance), distance, 1e-6 * part) << "pose " << i;
  }
#else
  GTEST_SKIP() << "FCL is not installed (tools/packages-bench.txt)";
#endif
}

INSTANTIATE_TEST_SUITE_P(SharedAssemblies, Completeness,
                         ::testing::Values("alpha15", "alpha20", "own_bolt_nut", "own_bolt_nut_fine",
                                           "own_tslot", "own_bearing", "factory_m16_loose",
                                           "factory_peg_round_loose", "factory_gear_medium", "screw_387266",
                                           "piston_head", "piston_crank", "press_p1p2", "press_p3p4",
                                           "gear_mesh", "box_finger", "featuretype_dock", "spot_link_dock"),
                         [](const auto& pair) { return std::string(pair.param); });

}  // namespace
}  // namespace aussois
