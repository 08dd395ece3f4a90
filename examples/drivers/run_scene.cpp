// SPDX-License-Identifier: Apache-2.0
// Runs any scene of the library with any scheme. Writes a run file with energies and joint coordinates and,
// if bodies have shapes, a replay for the browser.
//
// Theory   doc/index.md: the pages of the scheme and of the scene
// Run      run_scene --scene bricard --time 0.5 --h 2e-3
//          run_scene --scene rocking_block --scheme generalised_alpha --time 0.3
//          run_scene --scene pressed_peg --selector data/peg_selector.txt
// Expect   no refused step and no failure of the solver; exit code 0
#include <algorithm>
#include <cstdio>

#include "examples/common/driven_run.hpp"
#include "examples/scenes/library.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "io/record.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string scene{};
  bool list = false;
  double time = 0, h = 0;
  RunFlags run{};
  std::string said{};  // of the scene
  std::string command_line{};
};

ExitCode list() {
  for (const LibraryScene& s : library_scenes())
    std::printf("%-22s %s; %.3g s, h = %.3g s\n", s.name.c_str(), s.what.c_str(), s.t_end, s.h);
  return ExitCode::ok;
}

std::vector<Gauge> gauges_of(const Model& model) {
  std::vector<Gauge> out = gauges({"step", "t", "h", "contacts", "min_gap", "kinetic", "gravity", "laws",
                                   "residual", "worst_island", "energy_residual", "impulse_gain",
                                   "joint_drift", "joint_drift_angle", "displacement"});
  const std::vector<Gauge> totals =
      gauges({"total:max_contacts", "total:solver_failures", "total:energy_residual", "total:energy_rises",
              "total:impulse_gain"});
  for (const std::vector<Gauge>& more : {totals, model_gauges(model)})
    out.insert(out.end(), more.begin(), more.end());
  return out;
}

// What came of it, for people. True: nothing is wrong.
bool tell_end(const Arguments& a, const CaseScene& scene, const DrivenRun& run) {
  const Recording& r = run.recording;
  std::printf(
      "%s, %s: %s to t = %.6g s, up to %s, %s, largest displacement %.6g m, joint errors %.2g m, %.2g rad, "
      "energy %.6g to %.6g J (balanced to %.2g J per step), %.3g us per step\n",
      a.scene.c_str(), run.scheme.c_str(), counted_noun(r.steps(), "step").c_str(), run.state.t,
      counted_noun(std::int64_t(r.total("max_contacts")), "contact").c_str(),
      gap_text(r.total("min_gap")).c_str(), r.total("max_displacement"), r.total("joint_drift"),
      r.total("joint_drift_angle"), energy(scene.model, scene.state).total(),
      energy(scene.model, run.state).total(), r.total("energy_residual"),
      1e6 * run.step_cpu / double(std::max<std::int64_t>(1, r.steps() - run.first)));
  const auto rises = std::int64_t(r.total("energy_rises")),
             failures = std::int64_t(r.total("solver_failures"));
  if (rises > 0)
    std::fprintf(stderr, "contacts added energy in %s, %.3g J\n", counted_noun(rises, "step").c_str(),
                 r.total("impulse_gain"));
  if (failures > 0)
    std::fprintf(stderr, "not solved to the tolerance: %s\n", counted_noun(failures, "step").c_str());
  return print_findings(r.totals(), scene.model) && run.last.moved() && failures == 0;
}

ExitCode run_scene(const Arguments& a) {
  const LibraryScene& chosen = library_scene(a.scene);
  const CaseScene scene = chosen.make();
  validate_start(scene.model, scene.state);
  const SchemeFlags& flags = a.run.scheme;
  require(flags.selector.empty() || flags.selector_body < int(scene.model.bodies.size()),
          "--selector-body = " + std::to_string(flags.selector_body) + " must be less than " +
              std::to_string(scene.model.bodies.size()) + ", the bodies of the scene");
  RunPlan plan{.driver = "run_scene",
               .name = a.scene,
               .h = a.h > 0 ? a.h : chosen.h,
               .t_end = a.time > 0 ? a.time : chosen.t_end,
               .scene = a.said,
               .header = run_header(scene.model),
               .gauges = gauges_of(scene.model)};
  plan.header.title = "run_scene " + a.scene;
  plan.header.command_line = a.command_line;
  const double h = plan.h;
  const DrivenRun run = drive(scene.model, scene.state, std::move(plan), a.run);
  if (run.interrupted) return ExitCode::interrupted;
  if (!a.run.common.summary.empty()) {
    Summary out;
    out.set("scene", a.scene);
    out.set("scheme", run.scheme);
    out.set("options", run.options);
    out.set("h", h);
    out.set("t", run.state.t);
    out.set("refused_steps", std::int64_t(run.last.status == StepStatus::refused));
    out.set("energy_at_start", energy(scene.model, scene.state).total());
    out.set("energy_at_end", energy(scene.model, run.state).total());
    out.set("cpu_s", run.recording.cpu_seconds());
    set_run(run, out);
    write_summary(a.run.common.summary, out);
  }
  return tell_end(a, scene, run) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli("run_scene", "Runs a scene of the library with any scheme and records it.");
  cli.group("scene");
  cli.option("--scene", a.scene, "scene to run; --list shows all");
  cli.flag("--list", a.list, "list the scenes, then exit");
  cli.group("stepping");
  cli.option("--time", a.time, "time to simulate; 0: that of the scene", "s", kTime);
  cli.option("--h", a.h, "largest step; 0: that of the scene", "s",
             or_zero(setting_of<StepOptions>("h").range));
  add_run_options(cli, a.run);
  cli.example("run_scene --scene arch -o out", "25 stones stand; open out/replay.html");
  cli.example("run_scene --scene woodpecker -o out",
              "angles in out/steps.csv; no replay, because no body has a shape");
  cli.example("run_scene --scene arch --scheme moreau_jean_projected --time 1", "another scheme");
  return run_driver(cli, argc, argv, [&] {
    check(cli, a.run);
    a.said = scene_text(cli);
    return a.list ? list() : run_scene(a);
  });
}
