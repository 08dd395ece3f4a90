// SPDX-License-Identifier: Apache-2.0
#include "bench/dynamics_cost.hpp"

#include <algorithm>
#include <cmath>

#include "bench/call_time.hpp"

namespace aussois {
namespace {

constexpr int kJudgedSteps = 1000;  // between two checks whether to go on
constexpr double kTwoBounces =
    4;  // balls that fall 4.9 m meet the ground at 1 s and, without loss, at 3 s [s]

}  // namespace

const std::vector<DynamicsCase>& dynamics_cases() {
  static const std::vector<DynamicsCase> cases{
      {"rolling", 1e-3, 1e-8, 106},
      {"rolling_xy", 1e-3, 1e-8, 106},
      {"bouncing", 1e-2, 1e-12, 20, kTwoBounces},
      {"bouncing", 1e-3, 1e-12, 20, kTwoBounces},
      {"bouncing_08", 1e-3, 2e-4, 20, kTwoBounces},
      {"666", 1e-3, 1e-5, 600},
      {"666", 1e-2, 1e-3, 3000},
      {"tower", 1e-2, 1e-6, 150},
      {"tower", 1e-3, 1e-6, kInf},
      {"heavy_tower", 1e-2, 1e-4, 1000},
      {"arch", 1e-2, 1e-4, 3000},
      {"arch", 1e-3, 1e-4, kInf},
  };
  return cases;
}

SceneCost measure_scene(const DynamicsCase& of, const std::vector<PeerEngine>& engines,
                        const DynamicsOptions& options, const std::function<bool(const std::string&)>& step) {
  const PeerScene scene = peer_scene(of.scene);
  SceneCost out{.of = of, .t_end = options.length * scene.t_end};
  const long steps = std::max(1L, std::lround(out.t_end / of.h)),
             timed =
                 std::max(1L, std::lround(std::max(std::min(options.t_timed, out.t_end), of.t_least) / of.h));
  out.t_timed = double(timed) * of.h;
  std::vector<const PeerEngine*> able;
  for (const PeerEngine& engine : engines) {
    if (!step(of.scene + ", " + engine.name)) return out;
    std::optional<EngineRun> run = engine.start(scene, of.h);
    if (!run) continue;
    PeerJudge judge(scene);
    judge.see(run->sample());
    for (long k = 0; k < steps && judge.fall_time() == kInf; ++k) {
      if (k % kJudgedSteps == 0 && !step(of.scene + ", " + engine.name)) return out;
      run->step();
      judge.see(run->sample());
    }
    able.push_back(&engine);
    out.engines.push_back({.engine = engine.name, .error = judge.error(), .fall_time = judge.fall_time()});
  }
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < able.size(); ++i) {
      EngineCost& cost = out.engines[i];
      if (!step(of.scene + ", " + cost.engine + ", round " + std::to_string(round + 1))) return out;
      const EngineRun run = *able[i]->start(scene, of.h);
      const double begin = cpu_seconds();
      for (long k = 0; k < timed; ++k) run.step();
      const double us = 1e6 * (cpu_seconds() - begin) / double(timed);
      cost.us = std::min(cost.us, us);
      cost.us_slowest = std::max(cost.us_slowest, us);
    }
  }
  return out;
}

}  // namespace aussois
