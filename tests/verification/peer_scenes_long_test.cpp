// SPDX-License-Identifier: Apache-2.0
// The scenes of peer_scenes_test.cpp at the lengths and bounds that the peers are compared at.
#include "tests/support/peer_run.hpp"

namespace aussois {
namespace {

PeerRun whole(const char* name, double h) {
  const PeerScene scene = peer_scene(name);
  return run_peer_scene(scene, kernel_options(scene, h), scene.t_end);
}

TEST(PeerScenesInFull, Rolling) {
  for (const char* name : {"rolling", "rolling_xy"}) EXPECT_LT(whole(name, 1e-3).error, 1e-8) << name;
}

TEST(PeerScenesInFull, Bouncing) {
  for (const double h : {1e-2, 1e-3}) EXPECT_LT(whole("bouncing", h).worst, 1e-12) << h;
}

// The impacts of the scheme are up to a step away from the exact ones, which is all of the error.
TEST(PeerScenesInFull, BouncingToRest) {
  EXPECT_LT(whole("bouncing_08", 1e-3).error, 2e-4);
}

TEST(PeerScenesInFull, Pile666) {
  const PeerRun fine = whole("666", 1e-3), coarse = whole("666", 1e-2);
  EXPECT_LT(fine.error, 1e-5);
  EXPECT_LT(coarse.error, 1e-3);
  EXPECT_LT(std::max(fine.energy_gain, coarse.energy_gain), 1e-6);
}

TEST(PeerScenesInFull, Towers) {
  EXPECT_LT(whole("tower", 1e-2).error, 1e-6);
  EXPECT_LT(whole("heavy_tower", 1e-2).error, 1e-6);
}

TEST(PeerScenesInFull, AnArchStandsForAMinute) {
  for (const double mu : {0.6, 0.35}) {
    const PeerScene scene = arch_scene({.mu = mu});
    const PeerRun run = run_peer_scene(scene, kernel_options(scene, 1e-2), 60, crown(scene));
    EXPECT_EQ(run.fall_time, kInf) << mu;
    EXPECT_LT(run.sunk, 1e-4) << mu;
    EXPECT_LT(run.error, 1e-4) << mu;
  }
}

TEST(PeerScenesInFull, AnArchOfAHundredAndOneStonesStands) {
  const PeerScene scene = peer_scene("arch_101");
  EXPECT_LT(run_peer_scene(scene, kernel_options(scene, 1e-2), 5).error, 1e-6);
}

TEST(PeerScenesInFull, AHouseOfCardsStands) {
  const PeerScene scene = peer_scene("kapla");
  EXPECT_LT(run_peer_scene(scene, kernel_options(scene, 1e-2), 5).error, 1e-6);
}

}  // namespace
}  // namespace aussois
