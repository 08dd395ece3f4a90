// SPDX-License-Identifier: Apache-2.0
// The scenes on which engines of rigid bodies are compared (doc/theory/peer_scenes.md): what exact contacts
// and exact impulses are worth. The whole lengths are in peer_scenes_long_test.cpp.
#include <algorithm>
#include <cmath>

#include "tests/support/message_of.hpp"
#include "tests/support/peer_run.hpp"

namespace aussois {
namespace {

TEST(PeerScenes, StartExactlyClosed) {
  const struct {
    const char* name;
    int contacts;
  } closed[]{
      {"rolling", 4 + 25}, {"tower", 40}, {"heavy_tower", 40}, {"arch", 26 * 4}, {"arch_101", 102 * 4}};
  for (const auto& [name, contacts] : closed) {
    const PeerScene scene = peer_scene(name);
    const KernelScene k = kernel_scene(scene);
    const ContactSet found = MoreauJean(k.model, kernel_options(scene, 1e-2)).contacts(k.state, 1e-6);
    EXPECT_EQ(int(found.points.size()), contacts) << name;
    for (const ContactPoint& c : found.points) EXPECT_NEAR(c.gap, 0, 1e-14) << name;  // rounding at 20 m
  }
  for (const char* name : {"bouncing", "666", "666_elastic"}) {
    const PeerScene scene = peer_scene(name);
    PeerJudge judge(scene);
    judge.see(sample(kernel_scene(scene).state));
    EXPECT_EQ(judge.error(), 0) << name;
  }
}

// A stone by hand: a trapezium between the chords of its two radii.
TEST(PeerScenes, AStoneOfTheArchWeighsWhatItsTrapeziumDoes) {
  const PeerScene scene = arch_scene({.stones = 25, .thickness = 0.2});
  const double angle = kPi / 25, area = (1.1 * 1.1 - 0.9 * 0.9) * std::sin(angle) / 2;
  EXPECT_NEAR(scene.shapes[1].mass, 1000 * 0.2 * area, 1e-10);
  EXPECT_NEAR(scene.bodies[std::size_t(crown(scene))].g.p.x(), 0, 1e-14);
  EXPECT_GT(scene.bodies[std::size_t(crown(scene))].g.p.z(), 0.99);
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
    for (std::size_t b = 1; b < now.g.size(); ++b) now.g[b].p.z() = 0.1;
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

TEST(PeerScenes, ABoxUnderRollingBallsHasItsExactSpeedInAnyDirection) {
  for (const char* name : {"rolling", "rolling_xy"}) {
    const PeerScene scene = peer_scene(name);
    EXPECT_LT(run_peer_scene(scene, kernel_options(scene, 1e-3), 0.2).error, 1e-8) << name;
  }
}

TEST(PeerScenes, BouncingBallsKeepTheirEnergyAtAnyStep) {
  const PeerScene scene = peer_scene("bouncing");
  for (const double h : {1e-2, 3e-3})
    EXPECT_LT(run_peer_scene(scene, kernel_options(scene, h), 5).worst, 1e-12) << h;
}

TEST(PeerScenes, APileOfBallsDoesNotOverlapAndGainsNoEnergy) {
  const PeerScene scene = peer_scene("666");
  const PeerRun fine = run_peer_scene(scene, kernel_options(scene, 1e-3), 0.1),
                coarse = run_peer_scene(scene, kernel_options(scene, 1e-2), 0.5);
  EXPECT_LT(fine.error, 1e-5);
  EXPECT_LT(coarse.error, 1e-3);
  EXPECT_LT(std::max(fine.energy_gain, coarse.energy_gain), 1e-6);  // of 12.9 kJ
}

// Balls that fall on each other at e = 1, impacts at both sides in one step of 10 ms: (IMP-2) of all
// contacts, those that open too, keeps the energy to the solver's tolerance.
TEST(PeerScenes, AnElasticPileKeepsItsEnergyAtLongSteps) {
  const PeerScene scene = peer_scene("666_elastic");
  const KernelScene k = kernel_scene(scene);
  const MoreauJean scheme(k.model, kernel_options(scene, 1e-2));
  State state = k.state;
  const double before = energy(k.model, state).total();
  int hit = 0;
  while (state.t < 1) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_FALSE(report.energy_rises);
    hit += int(
        std::ranges::count_if(report.contacts, [](const StepContact& c) { return !c.impulse.isZero(0); }));
  }
  EXPECT_GT(hit, 100);
  EXPECT_NEAR(energy(k.model, state).total() / before, 1, 1e-9);
}

TEST(PeerScenes, TowersStand) {
  for (const char* name : {"tower", "heavy_tower"}) {
    const PeerScene scene = peer_scene(name);
    EXPECT_LT(run_peer_scene(scene, kernel_options(scene, 1e-2), 2).error, 1e-7) << name;
  }
}

// (PEER-2): least friction 0.30769, least thickness 0.10696, largest tilt 15.94 degrees with a friction of
// 0.6.
TEST(PeerScenes, AnArchStandsAndFallsWhereLimitAnalysisSays) {
  const auto run = [](const Arch& arch) {
    const PeerScene scene = arch_scene(arch);
    return run_peer_scene(scene, kernel_options(scene, 1e-2), 1, crown(scene));
  };
  for (const Arch& arch : {Arch{.mu = 0.6}, Arch{.mu = 0.35}, Arch{.tilt = 15 * kPi / 180}}) {
    const PeerRun stands = run(arch);
    EXPECT_EQ(stands.fall_time, kInf);
    EXPECT_LT(stands.error, 1e-7) << "friction " << arch.mu << " tilt " << arch.tilt;
  }
  for (const Arch& arch : {Arch{.mu = 0.25}, Arch{.thickness = 0.1}, Arch{.tilt = 18 * kPi / 180}})
    EXPECT_LT(run(arch).fall_time, 1)
        << "friction " << arch.mu << " thickness " << arch.thickness << " tilt " << arch.tilt;
}

// Bodies that fall together leave nothing but rounding between them: next to nothing to solve.
TEST(PeerScenes, AHouseOfCardsFallsAsOne) {
  const PeerScene scene = peer_scene("kapla");
  KernelScene k = kernel_scene(scene);
  const State start = k.state;
  for (std::size_t b = 1; b < k.state.g.size(); ++b) k.state.g[b].p.z() += 0.5;
  const MoreauJean scheme(k.model, kernel_options(scene, 1e-2));
  for (int i = 0; i < 3; ++i) {
    const StepReport report = scheme.step(k.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_GT(report.contacts_found, 500);
    EXPECT_LE(report.solve.iterations + report.solve.newton_iterations, 20);
    EXPECT_EQ(report.solve.status, SolveStatus::at_rounding);  // the residual is one of rounding's own size
  }
  const double fallen = k.state.g[1].p.z() - start.g[1].p.z() - 0.5;
  for (std::size_t b = 2; b < k.state.g.size(); ++b)
    EXPECT_NEAR(k.state.g[b].p.z() - start.g[b].p.z() - 0.5, fallen, 1e-14);
}

}  // namespace
}  // namespace aussois
