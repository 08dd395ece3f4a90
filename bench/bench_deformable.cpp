// SPDX-License-Identifier: Apache-2.0
// Steps ropes and soft blocks in our kernel, Bullet and MuJoCo, in one process: CPU time of a step, how much
// the rope has stretched and the deepest point under the floor.
//
// Theory   doc/theory/beams.md, doc/theory/solids.md
// Run      bench_deformable
//          bench_deformable --scene rope --elements 1000 --rounds 3 --json out/bench_deformable.json
// Expect   a line per scene and engine; ratios are ours to the peer's
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "bench/call_time.hpp"
#include "bench/peer_soft.hpp"
#include "bench/verdict.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"

using namespace aussois;

namespace {

constexpr double kStep = 1e-3;  // [s]

struct Arguments {
  std::string scene = "all";
  int elements = 0, cells = 6, rounds = 3, steps = 200;
  std::filesystem::path json{};
  CommonOptions common{};
};

// A scene, ready for any engine.
struct Scene {
  std::string name{};
  bool is_rope = true;
  std::function<std::optional<SoftRun>(const SoftEngine&)> start{};
};

std::vector<Scene> scenes_of(const Arguments& a) {
  std::vector<Scene> out;
  const auto wanted = [&](const char* name) { return a.scene == "all" || a.scene == name; };
  for (const bool on_floor : {false, true}) {
    if (!wanted(on_floor ? "rope_on_floor" : "rope")) continue;
    for (const int n : a.elements > 0 ? std::vector<int>{a.elements} : std::vector<int>{100, 1000}) {
      const RopeScene scene{.elements = n, .on_floor = on_floor};
      out.push_back({(on_floor ? "rope_on_floor " : "rope ") + std::to_string(n), true,
                     [scene](const SoftEngine& engine) { return engine.rope(scene, kStep); }});
    }
  }
  if (wanted("block")) {
    const BlockScene scene{.cells = a.cells};
    out.push_back({"block " + std::to_string(a.cells) + "^3", false,
                   [scene](const SoftEngine& engine) { return engine.block(scene, kStep); }});
  }
  return out;
}

struct Cost {
  std::string scene{}, engine{};
  double ms = kInf;    // CPU time of a step, of the fastest round
  double stretch = 0;  // of a rope at the end, relative; negative: shorter
  double below = 0;    // the deepest point under the floor at the end [m]
};

double length_of(const std::vector<Vec3>& points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

std::optional<Cost> measure(const Scene& scene, const SoftEngine& engine, int rounds, int steps) {
  Cost out{.scene = scene.name, .engine = engine.name};
  for (int round = 0; round < rounds; ++round) {
    const std::optional<SoftRun> run = scene.start(engine);
    if (!run) return std::nullopt;
    const double laid = length_of(run->points());
    const double begin = cpu_seconds();
    for (int k = 0; k < steps; ++k) run->step();
    out.ms = std::min(out.ms, 1e3 * (cpu_seconds() - begin) / steps);
    const std::vector<Vec3> points = run->points();
    out.stretch = scene.is_rope ? length_of(points) / laid - 1 : 0;
    out.below = 0;
    for (const Vec3& x : points) out.below = std::max(out.below, -x.z());
  }
  return out;
}

void write_json(const std::filesystem::path& path, const std::vector<Cost>& costs) {
  nlohmann::ordered_json out{{"h", kStep}, {"costs", nlohmann::ordered_json::array()}};
  for (const Cost& c : costs)
    out["costs"].push_back(
        {{"scene", c.scene}, {"engine", c.engine}, {"ms", c.ms}, {"stretch", c.stretch}, {"below", c.below}});
  write_whole_file(path, out.dump(1) + "\n");
}

ExitCode bench(const Arguments& a) {
  const std::vector<SoftEngine> engines = soft_engines();
  if (engines.size() == 1)
    std::fprintf(stderr, "no peer: neither Bullet nor MuJoCo was found at configuration\n");
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
  const std::vector<Scene> scenes = scenes_of(a);
  require(!scenes.empty(), "--scene = " + a.scene + " must be rope, rope_on_floor, block or all");
  std::vector<Cost> costs;
  Progress progress("bench_deformable", double(scenes.size()), Progress::style_of_stderr(a.common.quiet));
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const SoftEngine& engine : engines) {
      progress.at(double(i), scenes[i].name + ", " + engine.name);
      if (interrupted()) return ExitCode::interrupted;
      if (std::optional<Cost> cost = measure(scenes[i], engine, a.rounds, a.steps))
        costs.push_back(std::move(*cost));
    }
  std::printf("\n%-20s %-9s %9s %9s %11s %11s\n", "scene", "engine", "ms/step", "ratio", "stretch",
              "below [m]");
  double ours = kInf;
  for (const Cost& c : costs) {
    if (c.engine == "aussois") ours = c.ms;
    const bool hangs = c.scene.starts_with("rope ");
    std::printf("%-20s %-9s %9.3f %9.2f %11s %11s\n", c.scene.c_str(), c.engine.c_str(), c.ms, ours / c.ms,
                c.scene.starts_with("rope") ? formatted("%.2g", c.stretch).c_str() : "-",
                hangs ? "-" : formatted("%.2g", c.below).c_str());
  }
  if (!a.json.empty()) write_json(a.json, costs);
  return ExitCode::ok;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "bench_deformable",
      "Steps a rope that hangs by one end, a rope on a floor and a soft block that falls on it, at 1 ms, in "
      "our "
      "kernel (geometrically exact cables and solids, Coulomb's law to 1e-8, certified), in Bullet (capsules "
      "on "
      "ball joints; its implicit neo-Hookean solids) and in MuJoCo (capsules on ball joints with the rope's "
      "stiffness, up to 200). Prints the CPU time of a step on one thread, the least of several rounds, ours "
      "over "
      "the engine's, how much the rope is longer than it was laid, and how deep points of the body lie under "
      "the floor.");
  cli.group("scene");
  cli.option("--scene", a.scene, "rope, rope_on_floor, block or all");
  cli.option("--elements", a.elements, "of the ropes; 0: 100, then 1000", "", {0, 100000});
  cli.option("--cells", a.cells, "along each edge of the block", "", {1, 40});
  cli.group("measurement");
  cli.option("--rounds", a.rounds, "of timing", "", {1, 1000});
  cli.option("--steps", a.steps, "of each round", "", {1, 1000000});
  cli.option("--json", a.json, "file for all numbers");
  cli.common(a.common);
  cli.example("bench_deformable --scene rope --elements 1000", "one scene");
  cli.example("bench_deformable --rounds 9 --json out/bench_deformable.json", "less noise; results kept");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
