// SPDX-License-Identifier: Apache-2.0
// The scenes on which engines of rigid bodies are compared (doc/theory/peer_scenes.md), and their judge. What
// the kernel makes of them are rows of the driver `verify`, group G.
#include "examples/scenes/peer_scenes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// A stone by hand: a trapezium between the chords of its two radii.
TEST(PeerScenes, AStoneOfTheArchWeighsWhatItsTrapeziumDoes) {
  const PeerScene scene = arch_scene({.stones = 25, .thickness = 0.2});
  const double angle = kPi / 25, area = (1.1 * 1.1 - 0.9 * 0.9) * std::sin(angle) / 2;
  EXPECT_NEAR(scene.shapes[1].mass, 1000 * 0.2 * area, 1e-10);
  EXPECT_NEAR(scene.bodies[crown(scene)].g.p.x(), 0, 1e-14);
  EXPECT_GT(scene.bodies[crown(scene)].g.p.z(), 0.99);
}

// What is judged must not pass by itself: one body off its place, one speed off, one ball too deep.
TEST(PeerScenes, TheJudgeSeesWhatIsWrong) {
  const PeerScene tower = peer_scene("tower"), rolling = peer_scene("rolling"), pile = peer_scene("666"),
                  bouncing = peer_scene("bouncing_08");
  PeerSample now = sample(kernel_scene(tower).state);
  now.g[5].p.x() += 0.03;
  PeerJudge of_tower(tower);
  of_tower.see(now);
  EXPECT_DOUBLE_EQ(of_tower.error(), 0.03);
  EXPECT_EQ(of_tower.fall_time(), kInf);
  now.g[5].p.x() += 0.1;
  now.t = 2;
  of_tower.see(now);
  EXPECT_EQ(of_tower.fall_time(), 2);

  now = sample(kernel_scene(rolling).state);
  now.t = 2;
  now.v[1].y() = 1.01 * 2 * (150 - 0.4 * 35 * 9.81) / (10 + 50.0 / 7);  // 25 balls take 2/7 of 1 kg along
  PeerJudge of_rolling(rolling);
  of_rolling.see(now);
  EXPECT_NEAR(of_rolling.error(), 0.01, 1e-12);

  now = sample(kernel_scene(pile).state);
  now.g[7].p.z() = 0.098;
  PeerJudge of_pile(pile);
  of_pile.see(now);
  EXPECT_NEAR(of_pile.error(), 0.002, 1e-12);

  // At rest from the first impact at 0.99949 s on: the energy that is missing is 0.64, from the second at
  // 2.59867 s on 0.4096.
  PeerJudge of_bouncing(bouncing);
  now = sample(kernel_scene(bouncing).state);
  of_bouncing.see(now);
  for (const double t : {2.5986, 2.5987}) {
    for (std::size_t b = 1; b < now.g.size(); ++b) now.g[BodyId::at(b)].p.z() = 0.1;
    now.t = t;
    of_bouncing.see(now);
    EXPECT_NEAR(of_bouncing.worst(), 0.64, 1e-12);
  }
  EXPECT_NEAR(of_bouncing.error(), (0.64 + 0.64 * 0.64) / 3, 1e-12);
}

TEST(PeerScenes, NamesAndArchesAreCheckedAtTheDoor) {
  EXPECT_NE(message_of([] { peer_scene("pisa"); }).find("heavy_tower"), std::string::npos);
  EXPECT_NE(message_of([] { arch_scene({.stones = 2}); }).find("Arch::stones"), std::string::npos);
  EXPECT_NE(message_of([] { arch_scene({.thickness = 1}); }).find("Arch::thickness"), std::string::npos);
}

}  // namespace
}  // namespace aussois
