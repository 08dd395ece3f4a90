// SPDX-License-Identifier: Apache-2.0
// Any scene of the library by any scheme: a run file, a replay in the browser where bodies have
// shapes, energies, coordinates of joints.
//
// Theory   doc/index.md: the page of the scheme and of the scene
// Run      run_scene --scene bricard --time 0.5 --h 2e-3
//          run_scene --scene rocking_block --scheme generalised_alpha --time 0.3
//          run_scene --scene pressed_peg --selector data/peg_selector.txt
// Expect   no refused step, no failure of the solver; the exit code says whether
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <sstream>

#include "examples/common/audit_report.hpp"
#include "examples/common/energy_report.hpp"
#include "examples/common/match_report.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/restart.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/common/step_dump.hpp"
#include "examples/scenes/library.hpp"
#include "geometry/check.hpp"
#include "integrators/run.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string scene{};
  bool list = false;
  double time = 0, h = 0, tolerance = 1e-8;
  int certify = 0, stop_after = 0;
  SchemeFlags scheme{};
  CommonOptions common{};
  std::string command_line{}, settings{};  // settings: of the scheme
};

/// What the summary tells and a checkpoint keeps.
struct Statistics {
  std::int64_t steps = 0, solver_failures = 0, energy_rises = 0, max_contacts = 0;
  double min_gap = kInf, max_displacement = 0, joint_drift = 0, joint_drift_angle = 0, energy_residual = 0,
         impulse_gain = 0, cpu_s = 0;
  MatchTotals matches{};
  EnergyGain gain{};
  Uncertified uncertified{};
  PathAudit audit{};
};

ExitCode list() {
  for (const LibraryScene& s : library_scenes())
    std::printf("%-22s %s; %.3g s, h = %.3g s\n", s.name.c_str(), s.what.c_str(), s.t_end, s.h);
  return ExitCode::ok;
}

// ---- the table of steps: energies, work of contacts by their laws, then all coordinates by name

std::string name_of(const ContactLaw& law) {
  char text[80];
  std::snprintf(text, sizeof text, "mu %g e %g R_e %g", law.mu, law.restitution, law.contensou_radius);
  return text;
}

std::vector<std::string> columns_of(const Model& model) {
  std::vector<std::string> out{"step",
                               "t",
                               "h",
                               "contacts",
                               "min_gap",
                               "kinetic",
                               "gravity",
                               "laws",
                               "residual",
                               "energy_residual",
                               "impulse_gain",
                               "joint_drift",
                               "joint_drift_angle",
                               "displacement"};
  for (const ContactLaw& law : contact_laws(model)) out.push_back("work:" + name_of(law));
  for (const Joint& joint : model.joints) out.push_back("work:joint:" + joint.name);
  for (const Coordinates& block : model.coordinates)
    for (int i = 0; i < block.size; ++i) out.push_back("q:" + block.name + ":" + std::to_string(i));
  for (const Joint& joint : model.joints)
    for (int axis = 0; axis < axis_count(joint.kind); ++axis)
      out.push_back("joint:" + joint.name + ":" + std::to_string(axis));
  return out;
}

double displacement_of(const State& start, const State& state) {
  double out = 0;
  for (std::size_t b = 0; b < state.g.size(); ++b) out = std::max(out, (state.g[b].p - start.g[b].p).norm());
  return out;
}

std::vector<double> row_of(const Model& model, const State& state, const StepReport& report,
                           std::int64_t step, double displacement) {
  const Energy now = energy(model, state);
  std::vector<double> out{double(step),
                          report.t,
                          report.h,
                          double(report.contacts_kept),
                          report.min_gap,
                          now.kinetic,
                          now.gravity,
                          now.laws,
                          report.solve.residual,
                          report.energy.residual(),
                          report.impulse_gain,
                          report.joint_error.translation,
                          report.joint_error.rotation,
                          displacement};
  out.insert(out.end(), report.law_work.begin(), report.law_work.end());
  for (const StepJoint& joint : report.joints) out.push_back(joint.work.total());
  for (const double q : state.q) out.push_back(q);
  for (int j = 0; j < int(model.joints.size()); ++j)
    for (int axis = 0; axis < axis_count(model.joints[std::size_t(j)].kind); ++axis)
      out.push_back(joint_coordinate(model, state, j, axis));
  return out;
}

// ---- checkpoints

std::uint64_t fingerprint(const Arguments& a, const SchemeOptions& o) {
  std::ostringstream text;
  text << std::hexfloat << a.scene << ' ' << a.settings << ' ' << o.h << ' ' << a.tolerance << ' '
       << a.common.every << ' ' << a.certify;
  return fingerprint_of(text.str());
}

Checkpoint checkpoint_of(std::uint64_t print, const State& state, const Statistics& s, std::size_t csv_rows,
                         std::size_t run_rows) {
  Checkpoint out{.fingerprint = print,
                 .step = s.steps,
                 .state = state,
                 .numbers = {{"min_gap", s.min_gap},
                             {"max_displacement", s.max_displacement},
                             {"joint_drift", s.joint_drift},
                             {"joint_drift_angle", s.joint_drift_angle},
                             {"energy_residual", s.energy_residual},
                             {"impulse_gain", s.impulse_gain},
                             {"cpu_s", s.cpu_s}},
                 .counts = {{"solver_failures", s.solver_failures},
                            {"energy_rises", s.energy_rises},
                            {"max_contacts", s.max_contacts},
                            {"csv_rows", std::int64_t(csv_rows)},
                            {"run_rows", std::int64_t(run_rows)}}};
  MatchTotals matches = s.matches;
  add_matches(matches, {});  // all of them, also before the first step
  out.counts.insert(matches.begin(), matches.end());
  keep(s.audit, out);
  keep(s.gain, out);
  keep(s.uncertified, out);
  return out;
}

Statistics statistics_of(const Checkpoint& c) {
  MatchTotals matches;
  add_matches(matches, {});
  for (auto& [name, count] : matches) count = checkpoint_count(c, name);
  return {.steps = c.step,
          .solver_failures = checkpoint_count(c, "solver_failures"),
          .energy_rises = checkpoint_count(c, "energy_rises"),
          .max_contacts = checkpoint_count(c, "max_contacts"),
          .min_gap = checkpoint_number(c, "min_gap"),
          .max_displacement = checkpoint_number(c, "max_displacement"),
          .joint_drift = checkpoint_number(c, "joint_drift"),
          .joint_drift_angle = checkpoint_number(c, "joint_drift_angle"),
          .energy_residual = checkpoint_number(c, "energy_residual"),
          .impulse_gain = checkpoint_number(c, "impulse_gain"),
          .cpu_s = checkpoint_number(c, "cpu_s"),
          .matches = matches,
          .gain = energy_gain_of(c),
          .uncertified = uncertified_of(c),
          .audit = path_audit_of(c)};
}

void account(Statistics& s, const StepReport& report, double displacement) {
  ++s.steps;
  s.solver_failures += !is_solved(report.solve.status);
  s.energy_rises += report.energy_rises;
  if (report.energy_rises) s.impulse_gain += report.impulse_gain;
  add_matches(s.matches, report.matches);
  add(s.uncertified, report);
  s.max_contacts = std::max(s.max_contacts, std::int64_t(report.contacts_found));
  s.min_gap = std::min(s.min_gap, report.min_gap);
  s.max_displacement = std::max(s.max_displacement, displacement);
  s.joint_drift = std::max(s.joint_drift, report.joint_error.translation);
  s.joint_drift_angle = std::max(s.joint_drift_angle, report.joint_error.rotation);
  s.energy_residual = std::max(s.energy_residual, std::abs(report.energy.residual()));
}

Summary summary_of(const Arguments& a, const Model& model, const SchemeOptions& options, const Statistics& s,
                   const Energy& before, const Energy& after, const StepReport& last) {
  Summary out;
  out.set("scene", a.scene);
  out.set("scheme", label(a.scheme.scheme, options));
  out.set("h", options.h);
  out.set("t", last.t);
  out.set("steps", s.steps);
  out.set("refused_steps", std::int64_t(last.status == StepStatus::refused));
  out.set("solver_failures", s.solver_failures);
  out.set("max_contacts", s.max_contacts);
  out.set("min_gap", s.min_gap);
  out.set("max_displacement", s.max_displacement);
  out.set("joint_drift", s.joint_drift);
  out.set("joint_drift_angle", s.joint_drift_angle);
  out.set("energy_at_start", before.total());
  out.set("energy_at_end", after.total());
  out.set("energy_residual", s.energy_residual);
  out.set("energy_rises", s.energy_rises);
  out.set("impulse_gain", s.impulse_gain);
  set_gain(out, s.gain);
  out.set("cpu_s", s.cpu_s);
  set_matches(out, s.matches);
  set_uncertified(out, s.uncertified);
  set_audit(out, s.audit, model);
  return out;
}

ExitCode run(Arguments& a) {
  if (a.list) return list();
  const LibraryScene& chosen = library_scene(a.scene);
  const CaseScene scene = chosen.make();
  validate_start(scene.model, scene.state);
  SchemeOptions options = scheme_options(a.scheme);
  options.h = a.h > 0 ? a.h : chosen.h;
  if (a.scheme.min_h == 0) options.advancement.min_h = std::min(options.advancement.min_h, 1e-4 * options.h);
  options.solver.tolerance = a.tolerance;
  options.threads = a.common.threads;
  require(a.scheme.selector.empty() || a.scheme.selector_body < int(scene.model.bodies.size()),
          "--selector-body = " + std::to_string(a.scheme.selector_body) + " must be less than " +
              std::to_string(scene.model.bodies.size()) + ", the bodies of the scene");
  const Scheme scheme = make_scheme(a.scheme.scheme, scene.model, options);
  const double t_end = a.time > 0 ? a.time : chosen.t_end;
  make_folders(a.common);

  const std::uint64_t print = fingerprint(a, options);
  const std::filesystem::path checkpoint_file = a.common.out / "checkpoint.h5";
  const std::vector<std::string> columns = columns_of(scene.model);
  State state = scene.state;
  Statistics s{.gain = energy_gain(scene.model, scene.state)};
  std::size_t csv_rows = 0, run_rows = 0;
  std::string program = program_version();
  if (a.common.resume) {
    const Checkpoint c = checkpoint_to_resume(a.common, checkpoint_file, print);
    validate(scene.model, c.state);
    state = c.state;
    s = statistics_of(c);
    program = c.program;
    csv_rows = std::size_t(checkpoint_count(c, "csv_rows"));
    run_rows = std::size_t(checkpoint_count(c, "run_rows"));
  }
  s.audit.samples = a.certify;
  RunHeader header = run_header(scene.model);
  header.title = "run_scene " + a.scene;
  header.command_line = a.command_line;
  header.build = build_info();
  header.notes["scheme"] = label(a.scheme.scheme, options);
  RunWriter file = a.common.resume ? RunWriter::resume(a.common.out / "run.h5", run_rows)
                                   : RunWriter(a.common.out / "run.h5", header);
  CsvTable csv = a.common.resume ? CsvTable::resume(a.common.out / "steps.csv", columns, csv_rows)
                                 : CsvTable(a.common.out / "steps.csv", columns);
  note_other_program(file, program, s.steps);
  if (!a.common.resume) file.append(run_step(0, scene.model, state));

  Progress progress("run_scene", t_end, Progress::style_of_stderr(a.common.quiet));
  std::time_t last_checkpoint = std::time(nullptr);
  StepReport report;
  while (state.t < t_end * (1 - 1e-12)) {
    const State start = state;
    const std::clock_t begin = std::clock();
    report = scheme.step(state, t_end - state.t);
    s.cpu_s += double(std::clock() - begin) / CLOCKS_PER_SEC;
    if (!report.moved()) break;
    const double displacement = displacement_of(scene.state, state);
    account(s, report, displacement);
    add(scene.model, state, report, s.gain);
    audit_path(scene.model, start, state, report, a.common.threads, s.audit);
    if (s.steps % a.common.every == 0) {
      file.append(run_step(s.steps, scene.model, state, report));
      csv.add(row_of(scene.model, state, report, s.steps, displacement));
    }
    progress.at(state.t);
    const bool stop = interrupted() || (a.stop_after > 0 && s.steps >= a.stop_after);
    if (stop || double(std::time(nullptr) - last_checkpoint) >= a.common.checkpoint_every) {
      file.flush();
      csv.flush();
      write_checkpoint(checkpoint_file, checkpoint_of(print, state, s, csv.rows(), file.rows()));
      last_checkpoint = std::time(nullptr);
    }
    if (stop) {
      std::fprintf(stderr, "stopped after step %lld; continue with --resume\n",
                   static_cast<long long>(s.steps));
      return ExitCode::interrupted;
    }
  }
  csv.close();
  file.close();
  std::filesystem::remove(checkpoint_file);
  const std::filesystem::path replay = a.common.out / "replay.html";
  if (std::ranges::any_of(scene.model.bodies, [](const RigidBody& b) { return b.shape >= 0; })) {
    write_replay_html(replay, read_run(a.common.out / "run.h5"));
  } else {
    std::filesystem::remove(replay);  // that of another scene
    std::printf("no replay: no body of this scene has a shape\n");
  }
  if (report.status == StepStatus::not_finite)
    throw NumericalFailure("step " + std::to_string(s.steps + 1) + ": " + report.reason);

  const Energy before = energy(scene.model, scene.state), after = energy(scene.model, state);
  if (!a.common.summary.empty())
    write_summary(a.common.summary, summary_of(a, scene.model, options, s, before, after, report));
  std::printf(
      "%s, %s: %s to t = %.6g s, up to %s, %s, farthest from the start %.6g m, joints off by %.2g m, %.2g "
      "rad, energy %.6g to %.6g J (balance to %.2g J a step), %.3g us a "
      "step\n",
      a.scene.c_str(), label(a.scheme.scheme, options).c_str(), counted(s.steps, "step").c_str(), state.t,
      counted(s.max_contacts, "contact").c_str(), gap_text(s.min_gap).c_str(), s.max_displacement,
      s.joint_drift, s.joint_drift_angle, before.total(), after.total(), s.energy_residual,
      1e6 * s.cpu_s / double(std::max<std::int64_t>(1, s.steps)));
  if (report.status == StepStatus::refused)
    std::fprintf(stderr, "refused at t = %.6g s: %s\n", state.t, report.reason.c_str());
  if (s.energy_rises > 0)
    std::fprintf(stderr, "contact gave energy in %s, %.3g J\n", counted(s.energy_rises, "step").c_str(),
                 s.impulse_gain);
  tell(s.gain);
  if (s.solver_failures > 0)
    std::fprintf(stderr, "not solved to the tolerance: %s\n", counted(s.solver_failures, "step").c_str());
  tell(s.uncertified);
  const bool accepted = tell(s.audit, scene.model) && report.moved() && s.solver_failures == 0;
  return accepted ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  a.scheme.normal = to_string(NormalLaw::combined);
  Cli cli("run_scene", "Runs a scene of the library by any scheme and records it.");
  cli.group("scene");
  cli.option("--scene", a.scene, "by its name");
  cli.flag("--list", a.list, "names the scenes, and ends");
  cli.group("stepping");
  cli.option("--time", a.time, "to simulate; 0: that of the scene", "s", {0, 1e5});
  cli.option("--h", a.h, "largest step; 0: that of the scene", "s", {0, 1});
  cli.option("--certify", a.certify,
             "look at the path of every step at so many places, to check its certificate; 0: none", "",
             {0, 1000000});
  cli.option("--stop-after", a.stop_after, "stop with a checkpoint after this many steps; 0: never", "",
             {0, 1e9});
  add_options(cli, a.scheme);
  cli.group("solver");
  cli.option("--tolerance", a.tolerance, "on the scaled residual", "-", {1e-15, 0.1});
  cli.common(a.common, Cli::Restart::yes);
  cli.example("run_scene --scene arch -o out", "25 stones stand; the replay in out/replay.html");
  cli.example("run_scene --scene woodpecker -o out", "angles in out/steps.csv; no body has a shape to show");
  cli.example("run_scene --scene arch --scheme moreau_jean_projected --time 1", "another scheme");
  return run_driver(cli, argc, argv, [&] {
    refuse_unread(cli, a.scheme);
    a.settings = cli.values("scheme");
    return run(a);
  });
}
