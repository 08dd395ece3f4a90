// SPDX-License-Identifier: Apache-2.0
// Times whole steps of assemblies along their whole paths, stage by stage, with FCL's one distance at poses
// of the same run as the yardstick. Read the ratios, not the times.
//
// Theory   doc/theory/conservative_advancement.md (CA-21)
// Run      bench_step
//          bench_step --data DIR --json out/bench_step.json
// Expect   a block per pair; all paths run to their ends
#include <algorithm>
#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>

#include "bench/assembly_pairs.hpp"
#include "bench/step_cost.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path data{}, json{};
  std::string pairs{};
  double scale = 1e-3;
  StepCostOptions cost{};
  CommonOptions common{};
};

void print(const StepCost& cost) {
  const StageFigures step = figures_of(cost, "step");
  std::printf(
      "\n%s: %zu steps, %.0f contacts; CPU of a step %.3f ms, %.3g of FCL's distance (%.3f ms), p99 %.2f "
      "times the median\n%s",
      cost.pair.c_str(), cost.profile.steps(), cost.contacts, step.cpu_mean, ratio_to_fcl(cost), cost.ms_fcl,
      step.cpu_p99 / step.cpu_p50, table_of(cost.profile).c_str());
  if (!cost.ended.empty()) std::printf("ended early: %s\n", cost.ended.c_str());
}

nlohmann::ordered_json json_of(const StageFigures& f) {
  return {{"ms_p50", f.cpu_p50}, {"ms_p99", f.cpu_p99}, {"ms_max", f.cpu_most}, {"ms_mean", f.cpu_mean}};
}

nlohmann::ordered_json json_of(const StepCost& cost) {
  nlohmann::ordered_json out{
      {"pair", cost.pair}, {"steps", cost.profile.steps()}, {"contacts", cost.contacts}};
  out.update(json_of(figures_of(cost, "step")));
  out["ms_fcl"] = cost.ms_fcl;
  out["ratio_to_fcl"] = ratio_to_fcl(cost);
  out["kept_bytes"] = cost.profile.kept_bytes();
  for (const StageFigures& f : cost.profile.figures()) out["stages"][f.stage] = json_of(f);
  return out;
}

ExitCode bench(const Arguments& a) {
  require(a.common.threads == 1, "--threads must be 1: one thread is timed");
  const std::vector<std::string> names = pair_names(a.data, a.pairs);
  make_folders(a.common);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
  nlohmann::ordered_json json{{"pairs", nlohmann::ordered_json::array()}};
  Progress progress("bench_step", double(names.size()), Progress::style_of_stderr(a.common.quiet));
  bool all_ended_well = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const StepCost cost = measure_steps(read_pair(a.data, names[i], a.scale), a.cost, [&](double done) {
      progress.at(double(i) + done, names[i]);
      return !interrupted();
    });
    if (interrupted()) return ExitCode::interrupted;
    print(cost);
    all_ended_well = all_ended_well && cost.ended.empty();
    json["pairs"].push_back(json_of(cost));
    if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
  }
  return all_ended_well ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "bench_step",
      "Times whole steps along assembly paths, stage by stage, against FCL's distance at poses of the same "
      "run. Figures are CPU times of one thread.");
  cli.group("scene");
  cli.input("--data", a.data, "folder with meshes/ and assembly/; without it, our own bolt and nut");
  cli.option("--pair", a.pairs, "names of assembly/pairs.csv or bolt_nut, comma separated; empty: all");
  cli.option("--scale", a.scale, "metres per unit of the files", "m", {1e-12, 1e12});
  cli.group("measurement");
  cli.option("--steps", a.cost.steps, "most steps of each path; 0: all", "", {0, 1e9});
  cli.option("--fcl-poses", a.cost.fcl_poses, "poses at which FCL's distance is timed", "", {1, 1000});
  cli.option("--json", a.json, "file for all numbers, written after each pair");
  cli.common(a.common);
  cli.example("bench_step", "our own bolt and nut");
  cli.example("bench_step --data DIR --json out/bench_step.json", "all pairs");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
