// SPDX-License-Identifier: Apache-2.0
// Is a contact missing? The smallest distance of the contacts must be that of the meshes as FCL, which knows
// nothing of cones, regions or classes, finds it: on every pair and pose of the shared assemblies.
#include <cstdlib>

#include <gtest/gtest.h>

#include "bench/peer_fcl.hpp"
#include "examples/assembly/assembly_input.hpp"
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"
#include "lmd/find_contacts.hpp"

namespace aussois {
namespace {

class Completeness : public ::testing::TestWithParam<const char*> {};

TEST_P(Completeness, SmallestDistanceOfTheContactsIsThatOfTheMeshes) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  const AssemblyInput input = read_assembly_pair(data, GetParam(), 1e-3);
  const SimplicialComplex &moving = input.moving.complex, &fixed = input.fixed.complex;
  const Box& box = input.moving.report.box;
  const double part = (box.hi - box.lo).norm();
  // Two dilations fit the tightest of the paths (4.2e-4 of this radius).
  const double dilation = 2e-4 * radius_about(moving, (box.lo + box.hi) / 2);
  const LmdShape a = prepare({.complex = moving, .radius = dilation});
  const LmdShape b = prepare({.complex = fixed, .radius = dilation});
  const FclPair fcl(moving, fixed);
  ASSERT_FALSE(input.poses.empty());
  for (std::size_t i = 0; i < input.poses.size(); ++i) {
    const SE3& g = input.poses[i];
    const double distance = fcl.distance(g, {});
    ASSERT_GT(distance, 2 * dilation) << "pose " << i;
    const ContactSet found =
        find_contacts({&a, g, 0}, {&b, {}, 1}, {.threshold = 1.01 * distance - 2 * dilation});
    ASSERT_FALSE(found.points.empty()) << "pose " << i << ": distance " << distance << " m";
    EXPECT_NEAR(smallest_gap(found) + 2 * dilation, distance, 1e-6 * part) << "pose " << i;
    // Of the same base complexes the two agree to what regions and chains are off (lmd.md, Coverage).
    const double base = base_distance({&a, {}, {.g = g}}, {&b, {}, {}}, 1.01 * distance);
    EXPECT_NEAR(smallest_gap(found) + 2 * dilation, base, coverage_tolerance(a, b)) << "pose " << i;
  }
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
