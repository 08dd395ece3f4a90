// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "bench/peer_soft.hpp"
#include "bench/verdict.hpp"

namespace aussois {
namespace {

constexpr int kMost = 200;  // elements: its costs grow with the square of their number

// Its composite rope: capsules on pairs of hinges, which have the rope's stiffness against bending, EI / l.
std::string model_of(const RopeScene& scene, double h) {
  const double l = scene.length / scene.elements, r = scene.radius,
               bending = scene.young * kPi * r * r * r * r / 4 / l;
  std::string out = formatted(
      "<mujoco><option timestep=\"%.17g\" cone=\"elliptic\" gravity=\"0 0 -9.81\"/>"
      "<size nconmax=\"%d\" njmax=\"%d\" nstack=\"%d\"/><worldbody>",
      h, 4 * scene.elements, 16 * scene.elements, 30000000);
  if (scene.on_floor)
    out += formatted("<geom type=\"plane\" size=\"4 4 0.1\" friction=\"%.17g 0 0\"/>", scene.mu);
  out += formatted("<body name=\"B0\" pos=\"0 0 %.17g\">", scene.on_floor ? r + 1e-5 : 0.0);
  if (scene.on_floor) out += "<freejoint/>";
  out += formatted("<composite type=\"rope\" count=\"%d 1 1\" spacing=\"%.17g\">", scene.elements, l);
  out += formatted("<joint kind=\"main\" stiffness=\"%.17g\" damping=\"%.17g\"/>", bending, 1e-2 * bending);
  out += formatted(
      "<geom type=\"capsule\" size=\"%.17g %.17g\" density=\"%.17g\" contype=\"1\" conaffinity=\"0\"/>", r,
      std::max(l / 2 - r, 1e-4), scene.density);
  return out + "</composite></body></worldbody></mujoco>";
}

struct World {
  mjModel* model = nullptr;
  mjData* data = nullptr;

  World(const RopeScene& scene, double h) {
    const std::string text = model_of(scene, h);
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "rope.xml", int(text.size()));
    std::memcpy(files.filedata[0], text.data(), text.size());
    char error[500] = "";
    model = mj_loadXML("rope.xml", &files, error, sizeof error);
    mj_deleteVFS(&files);
    if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
    data = mj_makeData(model);
    mj_forward(model, data);
  }
  ~World() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  std::vector<Vec3> points() const {
    std::vector<Vec3> out;
    for (int b = 1; b < model->nbody; ++b) out.emplace_back(data->xpos + 3 * b);
    return out;
  }
};

}  // namespace

SoftEngine mujoco_soft_engine() {
  return {
      "mujoco",
      [](const RopeScene& scene, double h) -> std::optional<SoftRun> {
        if (scene.elements > kMost) return std::nullopt;
        const auto world = std::make_shared<World>(scene, h);
        return SoftRun{[world] { mj_step(world->model, world->data); }, [world] { return world->points(); }};
      },
      [](const BlockScene&, double) -> std::optional<SoftRun> { return std::nullopt; }};
}

}  // namespace aussois
