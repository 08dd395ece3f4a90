// SPDX-License-Identifier: Apache-2.0
// Replay a recorded assembly path of real parts: where they touch along it, or how the part moves when a
// six-axis spring pulls it along and the contacts with friction hold it back.
//
// Theory   doc/theory/moreau_jean.md (MJ-1) to (MJ-9), doc/theory/conservative_advancement.md (CA-4) to
// (CA-6),
//          doc/theory/virtual_coupling.md (VC-1) to (VC-5)
// Run      replay_assembly --builtin bolt_nut
//          replay_assembly --builtin bolt_nut --mode kinematic
// Expect   refused_steps = 0, solver_failures = 0, min_base_distance > 0, min_gap above -4 % of the two
//          dilations: AdvancementOptions::max_overlap, as (CA-6) has it
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <sstream>

#include "examples/assembly/assembly_scene.hpp"
#include "examples/common/audit_report.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/energy_report.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/restart.hpp"
#include "examples/common/step_dump.hpp"
#include "geometry/check.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"
#include "io/summary.hpp"
#include "lmd/coverage.hpp"
#include "mechanics/surface.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path data{}, fixed{}, moving{}, path{};
  std::string pair{}, builtin{}, mode = "dynamic", gravity = "-5.66,-5.66,-5.66";
  double scale = 1e-3;
  double threshold = 0;  // kinematic
  AssemblyOptions scene{};
  std::string normal_law = "combined";
  double theta = 1, tolerance = 1e-8;
  int stop_after = 0, certify = 0;
  DumpOptions dump{};
  CommonOptions common{};
  std::string command_line{};
};

/// Running statistics of a run: what the summary tells and a checkpoint keeps.
struct Statistics {
  std::int64_t steps = 0, refused_steps = 0, solver_failures = 0, max_contacts = 0, rows = 0,
               uncovered = 0;  // poses
  double min_gap = kInf, min_base_distance = kInf, peak_force = 0, peak_torque = 0, peak_contact_force = 0,
         max_lag = 0, final_lag = 0;
  double energy_error = 0, energy_scale = 0, cpu_s = 0;
  EnergyGain gain{};
  Uncertified uncertified{};
  PathAudit audit{};
  double energy_residual() const { return energy_scale > 0 ? energy_error / energy_scale : 0; }
};

// Of the whole process: clearance, queries, distances, steps, samples of paths, files.
double cpu_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

Vec3 parse_vector(const std::string& text, const char* flag) {
  Vec3 v;
  char rest = 0;
  require(std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &v[0], &v[1], &v[2], &rest) == 3 && v.allFinite(),
          std::string(flag) + " = " + text + " must be three numbers x,y,z");
  return v;
}

AssemblyInput read_input(const Arguments& a) {
  const bool files = !a.fixed.empty() || !a.moving.empty() || !a.path.empty();
  require(int(files) + int(!a.pair.empty()) + int(!a.builtin.empty()) == 1,
          "give one of: --data with --pair; --fixed, --moving and --path; --builtin");
  if (!a.builtin.empty()) return builtin_assembly(a.builtin);
  if (files) {
    require(!a.fixed.empty() && !a.moving.empty() && !a.path.empty(),
            "--fixed, --moving and --path belong together");
    return read_assembly_files(a.fixed, a.moving, a.path, a.scale);
  }
  require(!a.data.empty(), "--pair needs --data, the folder with meshes/ and assembly/");
  return read_assembly_pair(a.data, a.pair, a.scale);
}

void print_parts(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    for (const std::string& note : part->notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  for (const std::string& warning : scene.cache_warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (a.common.quiet) return;
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    std::printf("%s\n%s", part->name.c_str(), to_string(part->report).c_str());
  for (const std::string& line : scene.cache) std::printf("cache: %s\n", line.c_str());
  std::printf(
      "clearance %.4g um along %s, dilation %.4g um each, moving part %.4g kg (%s) at %.4g Hz, largest step "
      "%.4g ms, path %.4g s\n",
      1e6 * scene.clearance, counted(std::int64_t(scene.poses.size()), "pose").c_str(), 1e6 * scene.dilation,
      scene.model.bodies[std::size_t(scene.moving)].mass, scene.mass_source.c_str(), scene.frequency,
      1e3 * scene.h, scene.path.t.back());
  std::fflush(stdout);
}

RunHeader header_of(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  RunHeader header = run_header(scene.model);
  header.title = "replay_assembly " + input.name + ", " + a.mode;
  header.command_line = a.command_line;
  header.build = build_info();
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    for (const std::string& note : part->notes) header.notes[part->name] += note + "\n";
  header.notes["mass"] = scene.mass_source;
  return header;
}

Summary summary_of(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a,
                   const Statistics& s) {
  Summary out;
  out.set("pair", input.name);
  out.set("mode", a.mode);
  std::vector<std::string> notes;  // repairs of the meshes, and why a part is no solid
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    notes.insert(notes.end(), part->notes.begin(), part->notes.end());
  out.set("notes", notes);
  if (!scene.cache.empty()) out.set("cache", scene.cache);
  out.set("steps", s.steps);
  out.set("refused_steps", s.refused_steps);
  out.set("solver_failures", s.solver_failures);
  out.set("min_gap", s.min_gap);
  out.set("min_base_distance", s.min_base_distance);
  if (a.mode == "kinematic") out.set("uncovered_poses", s.uncovered);
  out.set("peak_force", s.peak_force);
  out.set("max_lag", s.max_lag);
  out.set("max_contacts", s.max_contacts);
  out.set("energy_residual", s.energy_residual());
  set_gain(out, s.gain);
  out.set("cpu_s", s.cpu_s);
  out.set("final_lag", s.final_lag);
  out.set("peak_torque", s.peak_torque);
  out.set("peak_contact_force", s.peak_contact_force);
  out.set("dilation", scene.dilation);
  out.set("clearance", scene.clearance);
  out.set("mass", scene.model.bodies[std::size_t(scene.moving)].mass);
  out.set("mass_source", scene.mass_source);
  out.set("h", scene.h);
  out.set("path_time", scene.path.t.back());
  out.set("frequency", scene.frequency);
  out.set("sag", scene.sag);
  set_uncertified(out, s.uncertified);
  set_audit(out, s.audit, scene.model);
  return out;
}

void finish(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a, const Statistics& s,
            RunWriter& run) {
  run.close();
  write_replay_html(a.common.out / "replay.html", read_run(a.common.out / "run.h5"));
  if (!a.common.summary.empty()) write_summary(a.common.summary, summary_of(input, scene, a, s));
}

// Where surfaces conform, most of the work is saved by starting from the smallest gap: it is the distance but
// for what faces and chains are idealised by. Should it be less than the distance, nothing is lost but time.
double base_distance_at(const AssemblyScene& scene, const State& state, const ContactSet& found,
                        double threshold, int threads) {
  const double cutoff = threshold + 2 * scene.dilation,
               near = std::min(cutoff, 1.001 * (smallest_gap(found) + 2 * scene.dilation));
  const double distance = min_base_distance(scene.model, state, near, threads);
  return distance < near || near == cutoff ? distance
                                           : min_base_distance(scene.model, state, cutoff, threads);
}

// ---- kinematic: the part stands at each recorded pose; nothing moves it but the path

ExitCode replay_kinematic(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  const double threshold = a.threshold > 0 ? a.threshold : 2 * scene.clearance;
  const MoreauJean scheme(scene.model, {.threads = a.common.threads});
  RunWriter run(a.common.out / "run.h5", header_of(input, scene, a));
  CsvTable csv(a.common.out / "poses.csv", {"pose", "contacts", "min_gap", "base_distance", "ms_query"});
  Progress progress("replay_assembly", double(scene.poses.size()), Progress::style_of_stderr(a.common.quiet));
  Statistics s;
  State state = start_of(scene);
  std::vector<double> ms;
  for (const SE3& pose_of_body : scene.poses) {
    pose(state, scene.moving) = pose_of_body;
    state.t = double(s.steps);
    const double begin = cpu_seconds();
    const ContactSet found = scheme.contacts(state, threshold);
    ms.push_back(1e3 * (cpu_seconds() - begin));
    const double distance = base_distance_at(scene, state, found, threshold, a.common.threads);
    RunStep row = run_step(s.steps, scene.model, state);
    for (const ContactPoint& c : found.points) row.contacts.push_back(run_contact(c));
    row.contacts_found = int(found.points.size());
    row.min_gap = smallest_gap(found);
    row.min_base_distance = distance;
    s.uncovered += distance < threshold + 2 * scene.dilation &&
                   !is_covered(posed_shape(scene.model, state, scene.fixed),
                               posed_shape(scene.model, state, scene.moving), distance, a.common.threads);
    run.append(row);
    csv.add({double(s.steps), double(found.points.size()), row.min_gap, distance, ms.back()});
    s.min_gap = std::min(s.min_gap, row.min_gap);
    s.min_base_distance = std::min(s.min_base_distance, distance);
    s.max_contacts = std::max(s.max_contacts, std::int64_t(found.points.size()));
    progress.at(double(++s.steps));
    if (interrupted()) return ExitCode::interrupted;
  }
  csv.close();
  s.cpu_s = cpu_seconds();
  finish(input, scene, a, s, run);
  std::ranges::sort(ms);
  std::printf(
      "%s: %s, %s (base distance %.4g um), up to %s within %.4g um, query median %.3g ms, slowest %.3g ms, "
      "%.3g s CPU in all\n",
      input.name.c_str(), counted(s.steps, "pose").c_str(), gap_text(s.min_gap).c_str(),
      1e6 * s.min_base_distance, counted(s.max_contacts, "contact").c_str(), 1e6 * threshold,
      ms[ms.size() / 2], ms.back(), s.cpu_s);
  if (s.uncovered > 0)
    std::fprintf(stderr, "smallest gap and base distance disagree at %s\n",
                 counted(s.uncovered, "pose").c_str());
  return s.min_base_distance > 0 && s.uncovered == 0 ? ExitCode::ok : ExitCode::not_accepted;
}

// ---- dynamic: the part is free and pulled along

const std::vector<std::string> kColumns{
    "step",    "t",        "h",        "contacts_found",    "contacts", "iterations",
    "newton",  "residual", "min_gap",  "min_base_distance", "energy",   "force",
    "torque",  "lag",      "attempts", "ms_contact",        "ms_solve", "ms_certificate",
    "ms_total"};

// How far behind the path the part is: its centre of mass, and its farthest point by rotation [m].
double lag_of(const AssemblyScene& scene, const State& state) {
  const SE3 on_path = evaluate(scene.path, state.t).pose, is = pose(state, scene.moving);
  return (on_path.p - is.p).norm() + scene.radius * angle_between(on_path.R, is.R);
}

// What the bits of a run depend on, as text. Threads, output and interruptions do not belong here.
std::uint64_t fingerprint(const AssemblyInput& input, const Arguments& a) {
  const AssemblyOptions& o = a.scene;
  std::ostringstream text;
  text << std::hexfloat << input.fingerprint << ' ' << o.dilation << ' ' << o.mu << ' ' << o.restitution
       << ' ' << o.density << ' ' << o.mass << ' ' << o.speed << ' ' << o.stride << ' ' << o.h << ' '
       << o.frequency << ' ' << o.damping_ratio << ' ' << o.force_limit << ' ' << o.torque_limit << ' '
       << o.hold << ' ' << o.gravity.transpose() << ' ' << o.misalignment << ' ' << a.theta << ' '
       << a.normal_law << ' ' << a.tolerance << ' ' << a.common.every;
  return fingerprint_of(text.str());
}

Checkpoint checkpoint_of(std::uint64_t print, const State& state, const Statistics& s, std::size_t csv_rows,
                         std::size_t run_rows) {
  Checkpoint out{.fingerprint = print,
                 .step = s.steps,
                 .state = state,
                 .numbers = {{"min_gap", s.min_gap},
                             {"min_base_distance", s.min_base_distance},
                             {"peak_force", s.peak_force},
                             {"peak_torque", s.peak_torque},
                             {"peak_contact_force", s.peak_contact_force},
                             {"max_lag", s.max_lag},
                             {"energy_error", s.energy_error},
                             {"energy_scale", s.energy_scale},
                             {"cpu_s", s.cpu_s}},
                 .counts = {{"solver_failures", s.solver_failures},
                            {"max_contacts", s.max_contacts},
                            {"csv_rows", std::int64_t(csv_rows)},
                            {"run_rows", std::int64_t(run_rows)}}};
  keep(s.audit, out);
  keep(s.gain, out);
  keep(s.uncertified, out);
  return out;
}

Statistics statistics_of(const Checkpoint& c) {
  const auto number = [&](const char* key) { return checkpoint_number(c, key); };
  return {.steps = c.step,
          .solver_failures = checkpoint_count(c, "solver_failures"),
          .max_contacts = checkpoint_count(c, "max_contacts"),
          .min_gap = number("min_gap"),
          .min_base_distance = number("min_base_distance"),
          .peak_force = number("peak_force"),
          .peak_torque = number("peak_torque"),
          .peak_contact_force = number("peak_contact_force"),
          .max_lag = number("max_lag"),
          .energy_error = number("energy_error"),
          .energy_scale = number("energy_scale"),
          .cpu_s = number("cpu_s"),
          .gain = energy_gain_of(c),
          .uncertified = uncertified_of(c),
          .audit = path_audit_of(c)};
}

void account(Statistics& s, const AssemblyScene& scene, const State& state, const StepReport& report,
             const CouplingWrench& pull) {
  ++s.steps;
  s.solver_failures += !is_solved(report.solve.status);
  s.max_contacts = std::max(s.max_contacts, std::int64_t(report.contacts_found));
  s.min_gap = std::min(s.min_gap, report.min_gap);
  s.min_base_distance = std::min(s.min_base_distance, report.min_base_distance);
  add(s.uncertified, report);
  s.peak_force = std::max(s.peak_force, pull.force.norm());
  s.peak_torque = std::max(s.peak_torque, pull.torque.norm());
  Vec3 contact = Vec3::Zero();
  for (const StepContact& c : report.contacts)
    contact += (c.point.a.body == scene.moving ? 1.0 : -1.0) * c.impulse;
  s.peak_contact_force = std::max(s.peak_contact_force, contact.norm() / report.h);
  s.max_lag = std::max(s.max_lag, lag_of(scene, state));
  s.energy_error += std::abs(report.energy.residual());
  s.energy_scale += std::abs(report.energy.law_work) + std::abs(report.energy.contact_work) +
                    std::abs(report.energy.kinetic_change);
}

ExitCode replay_dynamic(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  StepDump dump(a.dump, "replay_assembly_" + input.name);
  const MoreauJean scheme(scene.model, {.h = scene.h,
                                        .theta = a.theta,
                                        .normal = {.law = normal_law(a.normal_law)},
                                        .solver = {.tolerance = a.tolerance},
                                        .advancement = {.min_h = std::min(1e-7, scene.h)},
                                        .threads = a.common.threads,
                                        .keep_problem = dump.wants_problems()});
  const std::uint64_t print = fingerprint(input, a);
  const std::filesystem::path checkpoint_file = a.common.out / "checkpoint.h5";
  const double t_end = scene.path.t.back() + a.scene.hold;

  State state = start_of(scene);
  Statistics s{.gain = energy_gain(scene.model, state)};
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
  const double cpu_before = s.cpu_s;  // of the runs that this one continues
  s.audit.samples = a.certify;
  RunWriter run = a.common.resume ? RunWriter::resume(a.common.out / "run.h5", run_rows)
                                  : RunWriter(a.common.out / "run.h5", header_of(input, scene, a));
  CsvTable csv = a.common.resume ? CsvTable::resume(a.common.out / "steps.csv", kColumns, csv_rows)
                                 : CsvTable(a.common.out / "steps.csv", kColumns);
  note_other_program(run, program, s.steps);
  if (!a.common.resume) run.append(run_step(0, scene.model, state));

  const auto keep = [&] {
    s.cpu_s = cpu_before + cpu_seconds();
    run.flush();
    csv.flush();
    write_checkpoint(checkpoint_file, checkpoint_of(print, state, s, csv.rows(), run.rows()));
  };
  if (!a.common.quiet)
    std::printf("%s to take, more if some are cut\n",
                counted(std::int64_t(std::ceil((t_end - state.t) / scene.h - 1e-9)), "step").c_str());
  std::fflush(stdout);
  Progress progress("replay_assembly", t_end, Progress::style_of_stderr(a.common.quiet));
  std::time_t last_checkpoint = std::time(nullptr);
  StepReport report;
  while (state.t < t_end * (1 - 1e-12)) {
    const State start = state;
    report = scheme.step(state, t_end - state.t);
    dump.step(s.steps + 1, report);
    if (!report.moved()) break;
    const CouplingWrench pull =
        coupling_wrench(scene.model, state, scene.moving, scene.target, scene.coupling, state.t);
    account(s, scene, state, report, pull);
    add(scene.model, state, report, s.gain);
    audit_path(scene.model, start, state, report, a.common.threads, s.audit);
    if (s.steps % a.common.every == 0) run.append(run_step(s.steps, scene.model, state, report, pull));
    csv.add({double(s.steps), report.t, report.h, double(report.contacts_found), double(report.contacts_kept),
             double(report.solve.iterations), double(report.solve.newton_iterations), report.solve.residual,
             report.min_gap, report.min_base_distance, energy(scene.model, state).total(), pull.force.norm(),
             pull.torque.norm(), lag_of(scene, state), double(report.attempts), 1e3 * report.seconds_contact,
             1e3 * report.seconds_solve, 1e3 * report.seconds_certificate, 1e3 * report.seconds_total});
    char note[80];
    std::snprintf(note, sizeof note, "step %lld, %s", static_cast<long long>(s.steps),
                  counted(report.contacts_found, "contact").c_str());
    progress.at(state.t, note);
    const bool stop = interrupted() || (a.stop_after > 0 && s.steps >= a.stop_after);
    if (stop || double(std::time(nullptr) - last_checkpoint) >= a.common.checkpoint_every) {
      keep();
      last_checkpoint = std::time(nullptr);
    }
    if (stop) {
      std::fprintf(stderr, "stopped after step %lld; continue with --resume\n",
                   static_cast<long long>(s.steps));
      return ExitCode::interrupted;
    }
  }
  s.refused_steps += report.status == StepStatus::refused;
  s.min_gap = std::min(s.min_gap, smallest_gap(scheme.contacts(state, 2 * scene.clearance)));
  s.final_lag = lag_of(scene, state);
  s.cpu_s = cpu_before + cpu_seconds();
  csv.close();
  finish(input, scene, a, s, run);
  std::filesystem::remove(checkpoint_file);

  if (report.status == StepStatus::not_finite)
    throw NumericalFailure("step " + std::to_string(s.steps + 1) + ": " + report.reason);
  std::printf("%s: %s, %s, %s, pull up to %.3g N and %.3g N m, lag up to %.3g mm, up to %s, %.3g s CPU\n",
              input.name.c_str(), counted(s.steps, "step").c_str(), gap_text(s.min_gap).c_str(),
              distance_text(s.min_base_distance).c_str(), s.peak_force, s.peak_torque, 1e3 * s.max_lag,
              counted(s.max_contacts, "contact").c_str(), s.cpu_s);
  if (report.status == StepStatus::refused)
    std::fprintf(stderr, "refused at t = %.6g s: %s\n", state.t, report.reason.c_str());
  const double arrival = kArrival * scene.radius + std::abs(scene.misalignment);
  const bool arrived = s.final_lag <= arrival;
  if (!arrived)
    std::fprintf(stderr,
                 "the part did not arrive: %.4g mm behind the end of its path, more than %.4g mm; its weight "
                 "of %.4g N alone makes it hang up to %.4g mm off the path (--frequency = %.4g Hz)\n",
                 1e3 * s.final_lag, 1e3 * arrival,
                 scene.model.bodies[std::size_t(scene.moving)].mass * scene.model.gravity.norm(),
                 1e3 * scene.sag, scene.frequency);
  tell(s.gain);
  tell(s.uncertified);
  const bool accepted = tell(s.audit, scene.model) && arrived && s.refused_steps == 0 &&
                        s.solver_failures == 0 && s.min_base_distance > 0 &&
                        s.min_gap >= -0.05 * 2 * scene.dilation;
  return accepted ? ExitCode::ok : ExitCode::not_accepted;
}

ExitCode replay(Arguments& a) {
  require(a.mode == "dynamic" || (!a.common.resume && a.stop_after == 0),
          "--resume and --stop-after belong to --mode dynamic: a kinematic replay writes no checkpoint");
  step_choice(a.dump.steps);  // refused before anything runs
  require(a.mode == "dynamic" || a.certify == 0,
          "--certify belongs to --mode dynamic: a kinematic replay takes no steps");
  require(a.mode == "dynamic" || a.dump.folder.empty(),
          "--dump-problem belongs to --mode dynamic: a kinematic replay solves no problem");
  a.scene.gravity = parse_vector(a.gravity, "--gravity");
  const AssemblyInput input = read_input(a);
  AssemblyScene scene;
  {
    Progress progress("clearance", double(input.poses.size()), Progress::style_of_stderr(a.common.quiet));
    scene = make_assembly_scene(input, a.scene, a.common.threads, [&](int i, int) { progress.at(i); });
  }
  print_parts(input, scene, a);
  make_folders(a.common);
  return a.mode == "kinematic" ? replay_kinematic(input, scene, a) : replay_dynamic(input, scene, a);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli("replay_assembly", "Replays a recorded assembly path of two parts, with all their contacts.");
  cli.group("scene");
  cli.input("--data", a.data, "folder with meshes/ and assembly/");
  cli.option("--pair", a.pair, "name of a pair in assembly/pairs.csv");
  cli.input("--fixed", a.fixed, "mesh of the fixed part (OBJ, STL, PLY, OFF)");
  cli.input("--moving", a.moving, "mesh of the moving part");
  cli.input("--path", a.path,
            "poses of the moving part in the frame of the fixed one: CSV x,y,z,qw,qx,qy,qz");
  cli.option("--builtin", a.builtin, "a pair of our own: bolt_nut");
  cli.option("--scale", a.scale, "metres per unit of the files", "m", {1e-12, 1e12});
  cli.option("--cache", a.scene.cache, "folder that keeps prepared shapes for the next run; made if missing");
  cli.choice("--mode", a.mode, "kinematic: contacts at the recorded poses; dynamic: the part is pulled along",
             {"dynamic", "kinematic"});
  cli.option("--dilation", a.scene.dilation, "of each part; 0: three tenths of the clearance", "m", {0, 1});
  cli.option("--mu", a.scene.mu, "friction coefficient", "-", {0, 10});
  cli.option("--restitution", a.scene.restitution, "restitution coefficient", "-", {0, 1});
  cli.option("--density", a.scene.density, "of the moving part", "kg/m^3", {1e-3, 1e5});
  cli.option("--mass", a.scene.mass, "of the moving part; 0: from density and volume", "kg", {0, 1e6});
  cli.option("--gravity", a.gravity,
             "x,y,z in the frame of the fixed part, m/s^2; oblique by default, so that the part leans on it");
  cli.group("path");
  cli.option("--speed", a.scene.speed, "of the farthest point of the part along the path", "m/s",
             {1e-6, 1e3});
  cli.option("--misalignment", a.scene.misalignment,
             "of the coupling's target along (1, 1, 1), in clearances", "-", {-1e6, 1e6});
  cli.option("--frequency", a.scene.frequency,
             "of the part on its coupling; 0: 20, more for a part so small that its weight would pull it off",
             "Hz", {0, 1e5});
  cli.option("--damping-ratio", a.scene.damping_ratio, "of the coupling", "-", {0, 100});
  cli.option("--force-limit", a.scene.force_limit, "largest pull of the coupling", "N", {1e-9, kInf});
  cli.option("--torque-limit", a.scene.torque_limit, "largest torque of the coupling", "N m", {1e-12, kInf});
  cli.option("--hold", a.scene.hold, "time at the end of the path", "s", {0, 1e4});
  cli.group("stepping");
  cli.option("--stride", a.scene.stride, "largest motion per step, in sums of the two dilations", "-",
             {1e-3, 1e4});
  cli.option("--h", a.scene.h, "largest step; 0: from stride and speed", "s", {0, 1});
  cli.option("--theta", a.theta, "of the Moreau-Jean scheme", "-", {0.5, 1});
  cli.choice("--normal-law", a.normal_law, "what the normal rows of a step say (doc/theory/moreau_jean.md)",
             {"combined", "gap_over_step", "moreau"});
  cli.option("--certify", a.certify,
             "look at the path of every step at so many places, to check its certificate; 0: none", "",
             {0, 1000000});
  cli.option("--threshold", a.threshold, "kinematic: largest gap of a contact; 0: twice the clearance", "m",
             {0, 1});
  cli.option("--stop-after", a.stop_after, "stop with a checkpoint after this many steps; 0: never", "",
             {0, 1e9});
  cli.group("solver");
  cli.option("--tolerance", a.tolerance, "on the scaled residual", "-", {1e-15, 0.1});
  add_options(cli, a.dump);
  cli.common(a.common, Cli::Restart::yes);
  cli.example("replay_assembly --builtin bolt_nut -o out", "a nut turned off its bolt; open out/replay.html");
  cli.example(
      "replay_assembly --fixed rail.obj --moving slider.obj --path out.csv --scale 1e-3 -o out --summary "
      "out/s.json",
      "files in millimetres");
  return run_driver(cli, argc, argv, [&] { return replay(a); });
}
