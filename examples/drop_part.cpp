// SPDX-License-Identifier: Apache-2.0
// Drop a part on a plate: flight, impact, sliding and rest under Coulomb friction.
//
// Theory   doc/theory/moreau_jean.md (MJ-1) to (MJ-9), doc/theory/lmd.md (LMD-3)
// Run      drop_part
//          drop_part --builtin bolt --height 0.03 --mu 0.6
//          drop_part --time 0.3 --certify 100
// Expect   at rest at the end, overlap below 5 % of the two dilations, energy never rising
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "examples/assembly/assembly_input.hpp"
#include "examples/common/audit_report.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/match_report.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/step_dump.hpp"
#include "geometry/check.hpp"
#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/build_info.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path mesh{};
  std::string builtin = "box", normal_law = "combined";
  double scale = 1e-3, height = 0.05, tilt = 25, density = 7850, mass = 0, mu = 0.3, restitution = 0.2,
         dilation = 2e-4;
  double h = 1e-3, theta = 1, time = 1.5, tolerance = 1e-8;
  int certify = 0;  // samples of each step
  DumpOptions dump{};
  CommonOptions common{};
  std::string command_line{};
};

AssemblyPart part_of(const Arguments& a) {
  if (!a.mesh.empty()) return read_part(a.mesh, a.scale);
  AssemblyPart part{.name = a.builtin,
                    .complex = a.builtin == "bolt" ? make_bolt() : make_box(0.04, 0.03, 0.02)};
  part.report = report_mesh(part.complex);
  return part;
}

ExitCode drop(const Arguments& a) {
  // 1. The scene: a plate as wide as the part may roll, and the part.
  const AssemblyPart part = part_of(a);
  for (const std::string& note : part.notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  const PartMass mass = part_mass(part, a.dilation, a.density, a.mass);
  const double size = part.report.box.diagonal();
  Model model;
  model.contact_law = {.mu = a.mu, .restitution = a.restitution};
  const int plate = add(model, prepare(dilate(make_plate(20 * size, 20 * size), a.dilation)));
  const int shape = add(model, prepare(dilate(part.complex, a.dilation)));
  add(model, fixed_body("plate", plate));
  const int body = add(model, solid_body(part.name, shape, mass.properties));

  // 2. The start: tilted about an oblique axis, its lowest point at the height.
  State state = rest_state(model);
  pose(state, body).R = exp_so3(a.tilt * kPi / 180 * Vec3(2, 1, 0).normalized());
  double lowest = kInf;
  for (const Vec3& x : part.complex.vertices)
    lowest = std::min(lowest, (pose(state, body) * (model.bodies[std::size_t(body)].g_bs * x)).z());
  pose(state, body).p.z() = a.height + 2 * a.dilation - lowest;

  // 3. Motion; every step reports what happened.
  StepDump dump(a.dump, "drop_part_" + part.name);
  make_folders(a.common);
  const MoreauJean scheme(model, {.h = a.h,
                                  .theta = a.theta,
                                  .normal = {.law = normal_law(a.normal_law)},
                                  .solver = {.tolerance = a.tolerance},
                                  .threads = a.common.threads,
                                  .keep_problem = dump.wants_problems()});
  RunHeader header = run_header(model);
  header.title = "drop_part " + part.name;
  header.command_line = a.command_line;
  header.build = build_info();
  header.notes["mass"] = mass.source;
  RunWriter run(a.common.out / "run.h5", header);
  CsvTable csv(a.common.out / "steps.csv", {"step", "t", "h", "contacts", "min_gap", "energy", "residual"});
  run.append(run_step(0, model, state));
  Progress progress("drop_part", a.time, Progress::style_of_stderr(a.common.quiet));
  const double energy_scale =
      mass.properties.mass * 9.81 * (a.height + size);  // of the fall and of tipping over
  double energy_before = energy(model, state).total(), energy_rise = 0, min_gap = kInf;
  std::int64_t steps = 0, failures = 0;
  PathAudit audit{.samples = a.certify};
  MatchTotals matches;
  Uncertified uncertified;
  while (state.t < a.time * (1 - 1e-12)) {
    const State start = state;
    const StepReport report = scheme.step(state, a.time - state.t);
    dump.step(steps + 1, report);
    if (report.status == StepStatus::not_finite) throw NumericalFailure(report.reason);
    if (report.status == StepStatus::refused) {
      std::fprintf(stderr, "refused at t = %.6g s: %s\n", state.t, report.reason.c_str());
      return ExitCode::not_accepted;
    }
    audit_path(model, start, state, report, a.common.threads, audit);
    add(uncertified, report);
    failures += !report.ok();
    add_matches(matches, report.matches);
    min_gap = std::min(min_gap, report.min_gap);
    const double now = energy(model, state).total();
    energy_rise = std::max(energy_rise, now - energy_before);
    energy_before = now;
    if (++steps % a.common.every == 0) run.append(run_step(steps, model, state, report));
    csv.add({double(steps), report.t, report.h, double(report.contacts_kept), report.min_gap, now,
             report.solve.residual});
    progress.at(state.t);
    if (interrupted()) return ExitCode::interrupted;
  }
  csv.close();
  run.close();
  write_replay_html(a.common.out / "replay.html", read_run(a.common.out / "run.h5"));

  const Vec6 v = twist(state, body);
  const double speed = v.head<3>().norm() + v.tail<3>().norm() * size / 2;
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("steps", steps);
    summary.set("solver_failures", failures);
    summary.set("min_gap", min_gap);
    summary.set("energy_rise", energy_rise);
    summary.set("speed_at_end", speed);
    set_matches(summary, matches);
    set_uncertified(summary, uncertified);
    set_audit(summary, audit, model);
    write_summary(a.common.summary, summary);
  }
  std::printf("drop_part: %s, %s, speed at the end %.3g m/s, largest rise of energy %.3g J of %.3g J\n",
              counted(steps, "step").c_str(), gap_text(min_gap).c_str(), speed, energy_rise, energy_scale);
  const bool accepted = failures == 0 && tell(audit, model) && speed < 1e-3 &&
                        min_gap > -0.05 * 2 * a.dilation && energy_rise < 1e-4 * energy_scale;
  return accepted ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli("drop_part", "Drops a part on a plate and waits until it rests.");
  cli.group("scene");
  cli.input("--mesh", a.mesh, "OBJ, STL, PLY or OFF");
  cli.choice("--builtin", a.builtin, "a part of our own, if no mesh is given", {"box", "bolt"});
  cli.option("--scale", a.scale, "metres per unit of the file", "m", {1e-12, 1e12});
  cli.option("--height", a.height, "of the lowest point above the plate", "m", {0, 100});
  cli.option("--tilt", a.tilt, "about the axis (2, 1, 0)", "deg", {-180, 180});
  cli.option("--density", a.density, "of the part", "kg/m^3", {1e-3, 1e5});
  cli.option("--mass", a.mass, "of the part; 0: from density and volume", "kg", {0, 1e6});
  cli.option("--mu", a.mu, "friction coefficient", "-", {0, 10});
  cli.option("--restitution", a.restitution, "restitution coefficient", "-", {0, 1});
  cli.option("--dilation", a.dilation, "of part and plate", "m", {1e-9, 1});
  cli.group("stepping");
  cli.option("--time", a.time, "to simulate", "s", {1e-6, 1e4});
  cli.option("--h", a.h, "largest step", "s", {1e-7, 0.1});
  cli.option("--theta", a.theta, "of the Moreau-Jean scheme", "-", {0.5, 1});
  cli.choice("--normal-law", a.normal_law, "what the normal rows of a step say (doc/theory/moreau_jean.md)",
             {"combined", "gap_over_step", "moreau"});
  cli.option("--certify", a.certify,
             "look at the path of every step at so many places, to check its certificate; 0: none", "",
             {0, 1000000});
  cli.group("solver");
  cli.option("--tolerance", a.tolerance, "on the scaled residual", "-", {1e-15, 0.1});
  add_options(cli, a.dump);
  cli.common(a.common);
  cli.example("drop_part -o out", "a steel box; open out/replay.html");
  cli.example("drop_part --mesh bracket.obj --scale 1e-3 --mu 0.1 --h 5e-4", "your own part, in millimetres");
  return run_driver(cli, argc, argv, [&] { return drop(a); });
}
