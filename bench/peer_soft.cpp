// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_soft.hpp"

#include <memory>

#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/cable.hpp"
#include "mechanics/solid.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 1e-3;  // of floor and block [m]

struct World {
  Model model{};
  State state{};
  std::optional<MoreauJean> scheme{};
  std::function<std::vector<Vec3>(const World&)> points{};

  void advance() {
    const StepReport report = scheme->step(state);
    if (!report.ok()) throw std::runtime_error("aussois: " + report.reason);
  }
};

SoftRun run_of(const std::shared_ptr<World>& world, double h) {
  world->scheme.emplace(world->model, StepOptions{.h = h}, MoreauJeanOptions{.theta = 1});
  return {[world] { world->advance(); }, [world] { return world->points(*world); }};
}

void add_floor(Model& model) {
  RigidBody floor = fixed_body("floor", add(model, prepare(dilate(make_plate(4, 4), kDilation))));
  floor.g_bs.p.z() = -kDilation;
  add(model, std::move(floor));
}

std::optional<SoftRun> rope(const RopeScene& scene, double h) {
  const auto world = std::make_shared<World>();
  world->model.contact_law.mu = scene.mu;
  if (scene.on_floor) add_floor(world->model);
  const Vec3 first(0, 0, scene.on_floor ? scene.radius + 1e-5 : 0), last = first + Vec3(scene.length, 0, 0);
  const Cable cable = add_cable(
      world->model,
      {.name = "rope",
       .nodes = frames_along(points_along({first, last}, scene.elements + 1)),
       .section = beam_section(
           {.radius = scene.radius, .young = scene.young, .density = scene.density, .damping_time = 1e-2}),
       .radius = scene.on_floor ? scene.radius : 0,
       .straight = true});
  if (!scene.on_floor) world->model.bodies[cable.nodes.front()].motion = FixedMotion{};
  world->state = rest_state(world->model);
  lay(cable, world->state);
  world->points = [nodes = cable.nodes](const World& w) {
    std::vector<Vec3> out;
    for (const BodyId node : nodes) out.push_back(pose(w.state, node).p);
    return out;
  };
  return run_of(world, h);
}

std::optional<SoftRun> block(const BlockScene& scene, double h) {
  const auto world = std::make_shared<World>();
  world->model.contact_law.mu = scene.mu;
  add_floor(world->model);
  const Solid cube = add_solid(
      world->model, make_box_mesh(Vec3::Constant(scene.side), {scene.cells, scene.cells, scene.cells}),
      {.name = "cube",
       .materials = {{.young = scene.young, .poisson = scene.poisson, .density = scene.density}},
       .place = translation(0, 0, scene.side / 2 + kDilation + scene.side / 10),
       .smooth_strain = false,
       .radius = kDilation});
  world->state = rest_state(world->model);
  world->points = [cube](const World& w) { return solid_places(w.model, w.state, cube); };
  return run_of(world, h);
}

}  // namespace

SoftEngine aussois_soft_engine() {
  return {"aussois", rope, block};
}

std::vector<SoftEngine> soft_engines() {
  std::vector<SoftEngine> out{aussois_soft_engine()};
#ifdef AUSSOIS_BENCH_BULLET
  out.push_back(bullet_soft_engine());
#endif
#ifdef AUSSOIS_BENCH_MUJOCO
  out.push_back(mujoco_soft_engine());
#endif
  return out;
}

}  // namespace aussois
