// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_engine.hpp"

#include <memory>

#include "integrators/run.hpp"

namespace aussois {
namespace {

struct World {
  KernelScene scene{};
  Scheme scheme;
  double h = 0, t = 0;

  World(const PeerScene& peers, double step)
      : scene(kernel_scene(peers)),
        scheme(make_scheme("moreau_jean", scene.model, kernel_options(peers, step))),
        h(step) {}
  // A step that was cut is followed by others until h has passed, as the peers' step does. One that fails
  // leaves the clock behind and shows as an error of the scene.
  void advance() {
    (void)run(scheme, scene.state, t += h, [](const StepReport& report) { return report.moved(); });
  }
};

}  // namespace

PeerEngine aussois_engine() {
  return {"aussois", [](const PeerScene& scene, double h) -> std::optional<EngineRun> {
            const auto world = std::make_shared<World>(scene, h);
            return EngineRun{[world] { world->advance(); }, [world] { return sample(world->scene.state); }};
          }};
}

std::string peer_name(const char* name, const PeerTuning& tuning) {
  return std::string(name) + (tuning.steps > 1 || tuning.iterations > 1 ? "+" : "");
}

std::vector<PeerEngine> engines() {
  std::vector<PeerEngine> out{aussois_engine()};
  for (const PeerTuning& tuning : {PeerTuning{}, kTuned}) {
#ifdef AUSSOIS_BENCH_BULLET
    out.push_back(bullet_engine(tuning));
#endif
#ifdef AUSSOIS_BENCH_ODE
    out.push_back(ode_engine(tuning));
#endif
#ifdef AUSSOIS_BENCH_MUJOCO
    out.push_back(mujoco_engine(tuning));
#endif
    (void)tuning;  // no peer may be there
  }
  return out;
}

}  // namespace aussois
