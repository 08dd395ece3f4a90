// SPDX-License-Identifier: Apache-2.0
// Drops a part on a plate: flight, impact, sliding and rest under Coulomb friction.
//
// Theory   doc/theory/moreau_jean.md (MJ-1) to (MJ-9), doc/theory/lmd.md (LMD-3)
// Run      drop_part
//          drop_part --builtin bolt --height 0.03 --mu 0.6
//          drop_part --time 0.3 --certify 100
// Expect   the part rests at the end, overlaps at most by what a step may, and never gains energy
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "examples/common/driven_run.hpp"
#include "examples/drivers/assembly/assembly_input.hpp"
#include "geometry/fastener.hpp"
#include "geometry/number_text.hpp"
#include "geometry/primitives.hpp"
#include "io/record.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path mesh{};
  std::string builtin = "box";
  double scale = 1e-3, height = 0.05, tilt = 25, density = 7850, mass = 0, dilation = 2e-4;
  ContactLaw law{.mu = 0.3, .restitution = 0.2};
  double h = 1e-3, time = 1.5;
  RunFlags run{};
  std::string said{};  // of the scene
  std::string command_line{};
};

AssemblyPart part_of(const Arguments& a) {
  if (!a.mesh.empty()) return read_part(a.mesh, a.scale);
  AssemblyPart part{.name = a.builtin,
                    .complex = a.builtin == "bolt" ? make_bolt() : make_box(0.04, 0.03, 0.02)};
  part.report = report_mesh(part.complex);
  return part;
}

/// What a drop is judged by.
struct Drop {
  double speed = 0;    // at the end [m/s]
  double rise = 0;     // of energy in a step, of that of the fall [-]
  double overlap = 0;  // of the two dilations [-]
};

// Does the part rest, as the head of this file says? Prints what is wrong.
bool is_expected(const DrivenRun& run, const Model& model, const Drop& of) {
  bool all = print_findings(run.recording.totals(), model);
  const auto expect = [&](bool met, const std::string& wrong) {
    if (!met) std::fprintf(stderr, "drop_part: %s\n", wrong.c_str());
    all = all && met;
  };
  expect(run.last.moved(), "the last step was not taken: " + run.last.reason);
  expect(run.recording.total("solver_failures") == 0, "not every step was solved");
  expect(of.speed < 1e-3, "the part does not rest: at the end, 1 mm/s is the most");
  expect(of.overlap <= kLargestOverlap,
         "the part overlaps by more than " + number_text(100 * kLargestOverlap) + " % of the two dilations");
  expect(of.rise < 1e-4, "a step gained more than 1e-4 of the energy of the fall");
  return all;
}

ExitCode drop(const Arguments& a) {
  // 1. The scene: a plate as wide as the part may roll, and the part.
  AssemblyPart part = part_of(a);
  const PartMass mass = part_mass(part, a.dilation, a.density, a.mass);
  const double size = part.report.box.diagonal();
  Model model;
  model.contact_law = a.law;
  const auto plate = add(model, prepare(dilate(make_plate(20 * size, 20 * size), a.dilation)));
  const ShapeId shape = add(model, prepare(dilate(part.complex, a.dilation)));
  note_straightened(part, *model.shapes[shape]);
  for (const std::string& note : part.notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  add(model, fixed_body("plate", plate));
  const BodyId body = add(model, solid_body(part.name, shape, mass.properties));

  // 2. The start: tilted about an oblique axis, its lowest point at the height.
  State state = rest_state(model);
  pose(state, body).R = exp_so3(a.tilt * kPi / 180 * Vec3(2, 1, 0).normalized());
  double lowest = kInf;
  for (const Vec3& x : part.complex.vertices)
    lowest = std::min(lowest, (pose(state, body) * (model.bodies[body].g_bs * x)).z());
  pose(state, body).p.z() = a.height + 2 * a.dilation - lowest;

  // 3. Motion; every step is recorded.
  validate_start(model, state);
  RunPlan plan{.driver = "drop_part",
               .name = part.name,
               .h = a.h,
               .t_end = a.time,
               .scene = a.said,
               .header = run_header(model),
               .gauges = gauges({"step", "t", "h", "contacts", "min_gap", "energy", "residual",
                                 "worst_island", "total:solver_failures", "total:energy_rise"})};
  plan.header.title = "drop_part " + part.name;
  plan.header.command_line = a.command_line;
  for (const std::string& note : part.notes) plan.header.notes[part.name] += note + "\n";
  plan.header.notes["mass"] = mass.source;
  const DrivenRun run = drive(model, state, std::move(plan), a.run);
  if (run.interrupted) return ExitCode::interrupted;

  // 4. What became of it.
  const Recording& r = run.recording;
  const Vec6 v = twist(run.state, body);
  const double speed = v.head<3>().norm() + v.tail<3>().norm() * size / 2;
  if (!a.run.common.summary.empty()) {
    Summary summary;
    set_run(run, summary);
    summary.set("speed_at_end", speed);
    summary.set("scheme", run.scheme);
    summary.set("options", run.options);
    write_summary(a.run.common.summary, summary);
  }
  const double rise = r.total("energy_rise");
  const double E = mass.properties.mass * 9.81 * (a.height + size);  // of the fall and of tipping over
  std::printf("drop_part: %s, %s, final speed %.3g m/s, largest rise of energy %.3g J of %.3g J\n",
              counted_noun(r.steps(), "step").c_str(), gap_text(r.total("min_gap")).c_str(), speed, rise, E);
  const Drop of{.speed = speed, .rise = rise / E, .overlap = -r.total("min_gap") / (2 * a.dilation)};
  return is_expected(run, model, of) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli("drop_part", "Drops a part on a plate and checks that it comes to rest.");
  cli.group("scene");
  cli.input("--mesh", a.mesh, "mesh of the part (OBJ, STL, PLY or OFF); empty: --builtin");
  cli.choice("--builtin", a.builtin, "built-in part, used if no --mesh is given", {"box", "bolt"});
  cli.option("--scale", a.scale, "length of one unit of the mesh file", "m", kMeshScale);
  cli.option("--height", a.height, "initial height of the lowest point above the plate", "m", {0, 100});
  cli.option("--tilt", a.tilt, "initial tilt about the axis (2, 1, 0)", "deg", {-180, 180});
  cli.option("--density", a.density, "density of the part", "kg/m^3", kPartDensity);
  cli.option("--mass", a.mass, "mass of the part; 0: from density and volume", "kg", kPartMass);
  cli.option(setting_of<ContactLaw>("mu"), a.law.mu);
  cli.option(setting_of<ContactLaw>("restitution"), a.law.restitution);
  cli.stands_for("--restitution", "ContactLaw::restitution");
  cli.option("--dilation", a.dilation, "dilation of part and plate", "m", {1e-9, 1});
  cli.group("stepping");
  cli.option("--time", a.time, "time to simulate", "s", {1e-6, kTime.highest});
  cli.option("--h", a.h, "largest step", "s", setting_of<StepOptions>("h").range);
  add_run_options(cli, a.run);
  cli.example("drop_part -o out", "a steel box; open out/replay.html");
  cli.example("drop_part --mesh bracket.obj --scale 1e-3 --mu 0.1 --h 5e-4", "your own part, in millimetres");
  return run_driver(cli, argc, argv, [&] {
    check(cli, a.run);
    a.said = scene_text(cli);
    return drop(a);
  });
}
