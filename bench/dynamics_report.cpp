// SPDX-License-Identifier: Apache-2.0
#include "bench/dynamics_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "io/atomic_file.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

std::string key_of(const DynamicsCase& of) {
  return of.scene + formatted("_%g", of.h);
}

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

double ratio_to_bullet(const SceneCost& scene, const EngineCost& engine) {
  const auto bullet = std::ranges::find(scene.engines, "bullet", &EngineCost::engine);
  return bullet == scene.engines.end() ? std::numeric_limits<double>::quiet_NaN() : engine.us / bullet->us;
}

const char* what_of(const DynamicsCase& of) {
  switch (peer_scene(of.scene).measure) {
    case PeerMeasure::speed:
      return "speed, relative";
    case PeerMeasure::energy:
      return "energy, relative";
    case PeerMeasure::overlap:
      return "overlap [m]";
    case PeerMeasure::displacement:
      break;
  }
  return "displacement [m]";
}

}  // namespace

std::vector<Bar> dynamics_verdicts(const std::vector<SceneCost>& scenes) {
  std::vector<Bar> out;
  for (const SceneCost& scene : scenes) {
    if (scene.engines.empty()) continue;
    const EngineCost& ours = scene.engines.front();
    const std::string where = scene.of.scene + formatted(", h = %g s", scene.of.h);
    if (std::isfinite(scene.of.error))
      out.push_back({key_of(scene.of) + "_error", std::string("error, ") + what_of(scene.of), where,
                     ours.error, scene.of.error});
    if (std::isfinite(scene.of.us))
      out.push_back({key_of(scene.of) + "_us", "CPU time of a step [us]", where, ours.us, scene.of.us});
  }
  return out;
}

std::string dynamics_table_head() {
  return formatted("%-14s %7s %6s  %-9s %10s %9s %9s %9s %9s  %s\n", "scene", "h [s]", "T [s]", "engine",
                   "error", "falls [s]", "us/step", "slowest", "to Bullet", "error is of");
}

std::string lines_of(const SceneCost& scene) {
  std::string text;
  for (const EngineCost& e : scene.engines) {
    const std::string falls = std::isfinite(e.fall_time) ? formatted("%.2f", e.fall_time) : "-";
    text += formatted("%-14s %7g %6g  %-9s %10.2g %9s %9.1f %9.1f %9.2f  %s\n", scene.of.scene.c_str(),
                      scene.of.h, scene.t_end, e.engine.c_str(), e.error, falls.c_str(), e.us, e.us_slowest,
                      ratio_to_bullet(scene, e), what_of(scene.of));
  }
  return text;
}

void write_dynamics_json(const std::filesystem::path& path, const std::vector<SceneCost>& scenes) {
  Json out{{"scenes", Json::array()}, {"summary", Json::object()}};
  for (const SceneCost& scene : scenes) {
    Json of{{"scene", scene.of.scene},
            {"h", scene.of.h},
            {"t_end", scene.t_end},
            {"t_timed", scene.t_timed},
            {"error_is_of", what_of(scene.of)},
            {"engines", Json::object()}};
    for (const EngineCost& e : scene.engines)
      of["engines"][e.engine] = {{"error", number(e.error)},
                                 {"fall_time", number(e.fall_time)},
                                 {"us", number(e.us)},
                                 {"us_slowest", e.us_slowest},
                                 {"ratio", number(ratio_to_bullet(scene, e))}};
    out["scenes"].push_back(of);
  }
  bool pass = true;
  for (const Bar& v : dynamics_verdicts(scenes)) {
    out["summary"][v.key] = {{"value", v.value}, {"wanted", v.wanted}, {"pass", v.pass()}};
    pass = pass && v.pass();
  }
  out["summary"]["pass"] = pass;
  write_whole_file(path, out.dump(1) + "\n");
}

}  // namespace aussois
