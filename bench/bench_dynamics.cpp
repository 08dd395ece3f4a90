// SPDX-License-Identifier: Apache-2.0
// Runs the same scenes in our kernel, Bullet, ODE and MuJoCo, in one process. Reports the error of each
// engine, its CPU time per step in interleaved rounds, and verdicts on ours.
//
// Theory   doc/theory/peer_scenes.md
// Run      bench_dynamics
//          bench_dynamics --scene tower,arch --rounds 3 --json out/bench_dynamics.json
// Expect   a line per scene and engine, then a line per verdict, with PASS
#include <algorithm>
#include <cstdio>
#include <sstream>

#include "bench/dynamics_report.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string scenes{};
  std::filesystem::path json{};
  DynamicsOptions cost{};
  CommonOptions common{};
};

std::vector<DynamicsCase> cases_of(const std::string& names) {
  if (names.empty()) return dynamics_cases();
  std::vector<DynamicsCase> out;
  std::istringstream all(names);
  for (std::string name; std::getline(all, name, ',');) {
    peer_scene(name);  // throws for an unknown name
    const std::size_t before = out.size();
    std::ranges::copy_if(dynamics_cases(), std::back_inserter(out),
                         [&](const DynamicsCase& c) { return c.scene == name; });
    if (out.size() == before) out.push_back({.scene = name, .h = 1e-2});
  }
  return out;
}

ExitCode bench(const Arguments& a) {
  require(a.common.threads == 1, "--threads must be 1: one thread is timed");
  const std::vector<DynamicsCase> cases = cases_of(a.scenes);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
  const std::vector<PeerEngine> all = engines();
  if (all.size() == 1)
    std::fprintf(stderr, "no peer: neither Bullet nor ODE nor MuJoCo was found at configuration\n");

  // 1. Measure.
  std::vector<SceneCost> costs;
  Progress progress("bench_dynamics", double(cases.size()), Progress::style_of_stderr(a.common.quiet));
  for (const DynamicsCase& of : cases) {
    costs.push_back(measure_scene(of, all, a.cost, [&](const std::string& what) {
      progress.at(double(costs.size()), what);
      return !interrupted();
    }));
    if (interrupted()) return ExitCode::interrupted;
  }

  // 2. Report.
  std::printf("\n%s", dynamics_table_head().c_str());
  for (const SceneCost& cost : costs) std::printf("%s", lines_of(cost).c_str());
  if (!a.json.empty()) write_dynamics_json(a.json, costs);
  std::printf("\n");
  return print_verdicts(dynamics_verdicts(costs)) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "bench_dynamics",
      "Runs the scenes of the peers in our kernel and in Bullet (sequential impulses), ODE (QuickStep) and "
      "MuJoCo (Newton), without sleeping. Each peer runs with its defaults and, as NAME+, tuned by us: ten "
      "steps of its own in each step, and ten times the iterations. Prints the error of each engine, judged "
      "alike, and the CPU time of a step on one thread, the least of several rounds in turn. Peers that were "
      "not found at configuration are left out.");
  cli.group("scene");
  cli.option("--scene", a.scenes, "names, comma separated; empty: all that are compared");
  cli.option("--length", a.cost.length, "of every run, as a fraction of its scene's", "-", {1e-4, 1});
  cli.group("measurement");
  cli.option("--rounds", a.cost.rounds, "of timing, all engines in turn", "", {1, 1000});
  cli.option("--timed", a.cost.t_timed, "simulated time of a timed run at most", "s", {1e-3, 1e4});
  cli.option("--json", a.json, "file for all numbers");
  cli.common(a.common);
  cli.example("bench_dynamics --scene tower,heavy_tower", "two scenes");
  cli.example("bench_dynamics --rounds 9 --json out/bench_dynamics.json", "less noise; results kept");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
