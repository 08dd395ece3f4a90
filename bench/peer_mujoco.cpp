// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "bench/peer_engine.hpp"
#include "bench/verdict.hpp"

namespace aussois {
namespace {

constexpr int kContacts = 16;  // per body, at most
constexpr double kSteps = 10;  // that a bounce lasts

std::string text_of(const Vec3& x) {
  return formatted("%.17g %.17g %.17g", x.x(), x.y(), x.z());
}

// A spring and damper that turn a speed v into -e v within kSteps steps [Todorov2012].
std::string bounce_of(double restitution, double h) {
  const double damping = -std::log(restitution) / std::hypot(kPi, std::log(restitution));
  const double rate = kPi / (kSteps * h) / std::sqrt(1 - damping * damping);  // [1/s]
  return formatted(" solref=\"%.17g %.17g\" solimp=\"0.9999 0.9999 0.001 0.5 2\"", -rate * rate,
                   -2 * damping * rate);
}

std::string geom_of(const PeerScene& scene, const PeerBody& body, double h) {
  const PeerShape& shape = scene.shapes[body.shape];
  std::string out = "<geom ";
  switch (shape.kind) {
    case PeerShapeKind::ball:
      out += formatted("type=\"sphere\" size=\"%.17g\"", shape.size.x());
      break;
    case PeerShapeKind::box:
      out += "type=\"box\" size=\"" + text_of(shape.size / 2) + "\"";
      break;
    case PeerShapeKind::prism:
      out += formatted("type=\"mesh\" mesh=\"shape%d\"", body.shape.index());
      break;
  }
  // Of two priorities the higher one's friction counts: the smaller.
  out += formatted(" friction=\"%.17g 0 0\" condim=\"%d\" priority=\"%d\"", body.mu, body.mu > 0 ? 3 : 1,
                   int(1000 * (10 - body.mu)));
  if (scene.restitution > 0) out += bounce_of(scene.restitution, h);
  return out + "/>";
}

std::string model_of(const PeerScene& scene, double h) {
  const int contacts = kContacts * int(scene.bodies.size());
  const bool frictionless =
      std::ranges::all_of(scene.bodies, [](const PeerBody& body) { return body.mu == 0; });
  std::string out = formatted("<mujoco><option timestep=\"%.17g\" cone=\"elliptic\" gravity=\"", h) +
                    text_of(scene.gravity) + "\"><flag multiccd=\"enable\"/></option>" +
                    formatted("<size nconmax=\"%d\" njmax=\"%d\" nstack=\"%d\"/><asset>", contacts,
                              (frictionless ? 1 : 3) * contacts, 30000000);
  for (const ShapeId i : scene.shapes.ids()) {
    if (scene.shapes[i].kind != PeerShapeKind::prism) continue;
    out += formatted("<mesh name=\"shape%d\" vertex=\"", i.index());
    for (const Vec3& x : corners(scene.shapes[i], 0)) out += text_of(x) + " ";
    out += "\"/>";
  }
  out += "</asset><worldbody>";
  for (const PeerBody& body : scene.bodies) {
    const PeerShape& shape = scene.shapes[body.shape];
    const Quat& R = body.g.R;
    out += "<body pos=\"" + text_of(body.g.p) + "\"" +
           formatted(" quat=\"%.17g %.17g %.17g %.17g\">", R.w(), R.x(), R.y(), R.z());
    if (!body.fixed)
      out += "<freejoint/>" + formatted("<inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"", shape.mass) +
             text_of(shape.inertia.diagonal()) + "\"/>";
    out += geom_of(scene, body, h) + "</body>";
  }
  return out + "</worldbody></mujoco>";
}

struct World {
  mjModel* model = nullptr;
  mjData* data = nullptr;
  PerBody<SE3> start{};
  PerBody<char> fixed{};

  int steps = 1;

  World(const PeerScene& scene, double h, const PeerTuning& tuning) : steps(tuning.steps) {
    const std::string text = model_of(scene, h / tuning.steps);
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "scene.xml", int(text.size()));
    std::memcpy(files.filedata[0], text.data(), text.size());
    char error[500] = "";
    model = mj_loadXML("scene.xml", &files, error, sizeof error);
    mj_deleteVFS(&files);
    if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
    model->opt.iterations *= tuning.iterations;
    if (tuning.iterations > 1) model->opt.tolerance = 1e-15;  // its default, 1e-8, ends most solves before
    data = mj_makeData(model);
    for (const BodyId b : scene.bodies.ids()) {
      start.push_back(scene.bodies[b].g);
      fixed.push_back(scene.bodies[b].fixed);
      for (int i = 0; i < 3; ++i) data->xfrc_applied[6 * (b.index() + 1) + i] = scene.bodies[b].force[i];
    }
  }
  ~World() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void advance() {
    for (int k = 0; k < steps; ++k) mj_step(model, data);
  }
  PeerSample look() const {
    PeerSample out{.t = data->time, .g = start, .v = PerBody<Vec3>(start.size(), Vec3::Zero())};
    const mjtNum *q = data->qpos, *v = data->qvel;
    for (const BodyId b : start.ids()) {
      if (fixed[b]) continue;
      out.g[b] = {Quat(q[3], q[4], q[5], q[6]), Vec3(q[0], q[1], q[2])};
      out.v[b] = Vec3(v[0], v[1], v[2]);
      q += 7;
      v += 6;
    }
    return out;
  }
};

}  // namespace

PeerEngine mujoco_engine(const PeerTuning& tuning) {
  return {peer_name("mujoco", tuning),
          [tuning](const PeerScene& scene, double h) -> std::optional<EngineRun> {
            const auto world = std::make_shared<World>(scene, h, tuning);
            return EngineRun{[world] { world->advance(); }, [world] { return world->look(); }};
          }};
}

}  // namespace aussois
