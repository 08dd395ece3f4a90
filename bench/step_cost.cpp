// SPDX-License-Identifier: Apache-2.0
#include "bench/step_cost.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "bench/call_time.hpp"
#include "examples/drivers/assembly/assembly_scene.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/surface.hpp"
#ifdef AUSSOIS_BENCH_FCL
#include "bench/peer_fcl.hpp"
#endif

namespace aussois {
namespace {

using PosePair = std::pair<SE3, SE3>;  // of the fixed and of the moving shape

#ifdef AUSSOIS_BENCH_FCL
double mean_ms_of_fcl(const AssemblyScene& scene, const std::vector<PosePair>& poses) {
  const auto complex_of = [&](BodyId body) -> const SimplicialComplex& {
    return scene.model.shapes[scene.model.bodies[body].shape]->complex;
  };
  const FclPair pair(complex_of(scene.fixed), complex_of(scene.moving));
  const double begin = cpu_seconds();
  for (const auto& [fixed, moving] : poses) pair.distance(fixed, moving);
  return 1e3 * (cpu_seconds() - begin) / double(poses.size());
}
#endif

std::vector<PosePair> spread_evenly(const std::vector<PosePair>& all, int count) {
  std::vector<PosePair> out;
  const auto n = std::min(std::size_t(count), all.size());
  for (std::size_t i = 0; i < n; ++i) out.push_back(all[i * all.size() / n]);
  return out;
}

}  // namespace

StageFigures figures_of(const StepCost& cost, const std::string& stage) {
  for (const StageFigures& f : cost.profile.figures())
    if (f.stage == stage) return f;
  return {};
}

double ratio_to_fcl(const StepCost& cost) {
  return figures_of(cost, "step").cpu_mean / cost.ms_fcl;
}

StepCost measure_steps(const AssemblyInput& input, const StepCostOptions& options,
                       const std::function<bool(double)>& go_on) {
  const AssemblyScene scene = make_assembly_scene(input, {}, 1);
  const MoreauJean scheme(scene.model, {.h = scene.h, .profile = true}, {.theta = 1});
  const double t_end = scene.path.t.back() + AssemblyOptions{}.hold;
  StepCost out{.pair = input.name};
  State state = start_of(scene);
  std::vector<PosePair> poses;
  long contacts = 0;
  const auto place = [&](BodyId body) { return posed_shape(scene.model, state, body).g_ws; };
  PosePair before{place(scene.fixed), place(scene.moving)};
  const StepReport last = run(scheme, state, t_end, [&](const StepReport& report) {
    if (!report.moved()) return false;
    out.profile.add(report);
    poses.push_back(std::exchange(before, {place(scene.fixed), place(scene.moving)}));
    contacts += report.contacts_found;
    return go_on(state.t / t_end) && (options.steps == 0 || int(poses.size()) < options.steps);
  });
  if (!last.ok()) out.ended = last.reason;
  if (poses.empty()) return out;
  out.contacts = double(contacts) / double(poses.size());
#ifdef AUSSOIS_BENCH_FCL
  out.ms_fcl = mean_ms_of_fcl(scene, spread_evenly(poses, options.fcl_poses));
#endif
  return out;
}

}  // namespace aussois
