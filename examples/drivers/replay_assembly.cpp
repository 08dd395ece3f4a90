// SPDX-License-Identifier: Apache-2.0
// Replays a recorded assembly path of real parts: finds where they touch along the path, or simulates how the
// part moves when a six-axis spring pulls it along and contacts with friction hold it back.
//
// Theory   doc/theory/moreau_jean.md (MJ-1) to (MJ-9),
//          doc/theory/conservative_advancement.md (CA-4) to (CA-6),
//          doc/theory/virtual_coupling.md (VC-1) to (VC-5)
// Run      replay_assembly --builtin bolt_nut
//          replay_assembly --builtin bolt_nut --mode kinematic
// Expect   refused_steps = 0, solver_failures = 0, min_base_distance > 0, min_gap above -4.2 % of the two
//          dilations (kLargestOverlap), with --flexible of the largest two
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "examples/common/driven_run.hpp"
#include "examples/common/progress.hpp"
#include "examples/drivers/assembly/assembly_flags.hpp"
#include "examples/drivers/assembly/lay_cables.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "io/build_info.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"
#include "io/text.hpp"
#include "lmd/coverage.hpp"
#include "mechanics/surface.hpp"

using namespace aussois;

namespace {

struct Arguments {
  AssemblyFlags parts{.gravity = "-5.66,-5.66,-5.66"};
  std::filesystem::path flexible{};
  std::string mode = "dynamic";
  double threshold = 0;  // kinematic
  SaidSettings said{};   // of the scene
  RunFlags run{};
  const Cli* cli = nullptr;
  std::string command_line{};
};

// Of the whole process: clearance, queries, distances, steps, samples of paths, files.
double cpu_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

double length_of(const Cable& cable) {
  double sum = 0;
  for (const BeamElement& element : cable.beam.elements) sum += element.length;
  return sum;
}

std::vector<std::string> coarse_cables(const AssemblyScene& scene) {
  std::vector<std::string> out;
  for (const Cable& cable : scene.cables)
    if (std::string warning = too_coarse(cable); !warning.empty()) out.push_back(std::move(warning));
  return out;
}

void print_parts(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  print_warnings(input, scene);
  for (const std::string& warning : coarse_cables(scene))
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (a.run.common.quiet) return;
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    std::printf("%s\n%s", part->name.c_str(), to_string(part->report).c_str());
  for (const std::string& line : scene.cache) std::printf("cache: %s\n", line.c_str());
  std::printf(
      "clearance %.4g um along %s, dilation %.4g um each, moving part %.4g kg (%s) at %.4g Hz, largest step "
      "%.4g ms, path %.4g s\n",
      1e6 * scene.clearance, counted_noun(std::int64_t(scene.poses.size()), "pose").c_str(),
      1e6 * scene.dilation, scene.model.bodies[scene.moving].mass, scene.mass_source.c_str(), scene.frequency,
      1e3 * scene.h, scene.path.t.back());
  for (const Cable& cable : scene.cables)
    std::printf("%s: %.4g m long, %s\n", cable.beam.name.c_str(), length_of(cable),
                counted_noun(std::int64_t(cable.beam.elements.size()), "element").c_str());
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

// What a summary says of both modes, before and after what came of them.
Summary summary_of(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  Summary out;
  out.set("pair", input.name);
  out.set("mode", a.mode);
  std::vector<std::string> notes;  // repairs of the meshes, why a part is no solid, ...
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    notes.insert(notes.end(), part->notes.begin(), part->notes.end());
  for (std::string& warning : coarse_cables(scene)) notes.push_back(std::move(warning));
  out.set("notes", notes);
  if (!scene.cache.empty()) out.set("cache", scene.cache);
  out.set("dilation", scene.dilation);
  out.set("clearance", scene.clearance);
  out.set("mass", scene.model.bodies[scene.moving].mass);
  out.set("mass_source", scene.mass_source);
  out.set("h", scene.h);
  out.set("path_time", scene.path.t.back());
  out.set("frequency", scene.frequency);
  out.set("sag", scene.sag);
  return out;
}

void write(const Summary& summary, const Arguments& a) {
  if (!a.run.common.summary.empty()) write_summary(a.run.common.summary, summary);
}

const LmdShape& shape_of(const AssemblyScene& scene, BodyId body) {
  return *scene.model.shapes[scene.model.bodies[body].shape];
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
  const MoreauJean scheme(scene.model, {.threads = a.run.common.threads}, {.theta = 1});
  RunWriter run(a.run.common.out / "run.h5", header_of(input, scene, a));
  CsvTable csv(a.run.common.out / "poses.csv", {"pose", "contacts", "min_gap", "base_distance", "ms_query"});
  Progress progress("replay_assembly", double(scene.poses.size()),
                    Progress::style_of_stderr(a.run.common.quiet));
  std::int64_t poses = 0, uncovered = 0, max_contacts = 0;
  double min_gap = kInf, min_distance = kInf;
  State state = start_of(scene);
  std::vector<double> ms;
  for (const SE3& pose_of_body : scene.poses) {
    pose(state, scene.moving) = pose_of_body;
    state.t = double(poses);
    const double begin = cpu_seconds();
    const ContactSet found = scheme.contacts(state, threshold);
    ms.push_back(1e3 * (cpu_seconds() - begin));
    const double distance = base_distance_at(scene, state, found, threshold, a.run.common.threads);
    RunStep row = run_step(poses, scene.model, state);
    for (const ContactPoint& c : found.points) row.contacts.push_back(run_contact(c));
    row.contacts_found = int(found.points.size());
    row.min_gap = smallest_gap(found);
    row.min_base_distance = distance;
    const PosedShape fixed = posed_shape(scene.model, state, scene.fixed),
                     moving = posed_shape(scene.model, state, scene.moving);
    uncovered += distance < threshold + 2 * scene.dilation - coverage_tolerance(fixed, moving) &&
                 !is_covered_by(row.min_gap, fixed, moving, distance);
    run.append(row);
    csv.add({double(poses), double(found.points.size()), row.min_gap, distance, ms.back()});
    min_gap = std::min(min_gap, row.min_gap);
    min_distance = std::min(min_distance, distance);
    max_contacts = std::max(max_contacts, std::int64_t(found.points.size()));
    progress.at(double(++poses));
    if (interrupted()) return ExitCode::interrupted;
  }
  csv.close();
  run.close();
  RunReader recorded(a.run.common.out / "run.h5");
  write_replay_html(a.run.common.out / "replay.html", recorded);
  const double cpu = cpu_seconds();
  Summary summary = summary_of(input, scene, a);
  summary.set("steps", poses);
  summary.set("min_gap", min_gap);
  summary.set("min_base_distance", min_distance);
  summary.set("uncovered_poses", uncovered);
  summary.set("max_contacts", max_contacts);
  summary.set("cpu_s", cpu);
  write(summary, a);
  std::ranges::sort(ms);
  std::printf(
      "%s: %s, %s (base distance %.4g um), up to %s within %.4g um, query median %.3g ms, slowest %.3g ms, "
      "%.3g s CPU in total\n",
      input.name.c_str(), counted_noun(poses, "pose").c_str(), gap_text(min_gap).c_str(), 1e6 * min_distance,
      counted_noun(max_contacts, "contact").c_str(), 1e6 * threshold, ms[ms.size() / 2], ms.back(), cpu);
  if (uncovered > 0)
    std::fprintf(stderr, "smallest gap and base distance disagree at %s\n",
                 counted_noun(uncovered, "pose").c_str());
  return min_distance > 0 && uncovered == 0 ? ExitCode::ok : ExitCode::not_accepted;
}

// ---- dynamic: the part is free and pulled along

// How far behind the path the part is: its centre of mass, and its farthest point by rotation [m].
double lag_of(const AssemblyScene& scene, const State& state) {
  const SE3 on_path = trajectory_point(scene.path, state.t).pose, is = pose(state, scene.moving);
  return (on_path.p - is.p).norm() + scene.radius * angle_between(on_path.R, is.R);
}

CouplingWrench pull_at(const AssemblyScene& scene, const State& state) {
  return coupling_wrench(scene.model, state, scene.moving, scene.target, scene.coupling, state.t);
}

double contact_force(const Frame& f, BodyId moving) {
  Vec3 sum = Vec3::Zero();
  for (const StepContact& c : f.report.contacts) {
    if (c.point.a.body == moving) sum += c.impulse;
    if (c.point.b.body == moving) sum -= c.impulse;
  }
  return sum.norm() / f.report.h;
}

// The largest of all cables.
struct CableLoad {
  double tension = 0;    // [N]
  double curvature = 0;  // [1/m]
};
CableLoad largest_load(const AssemblyScene& scene, const State& state) {
  CableLoad out;
  for (const Cable& cable : scene.cables) {
    const std::vector<BeamLoad> loads = beam_loads(cable.beam, state);
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const BeamElement& element = cable.beam.elements[i];
      const Vec6 bent = element.rest / element.length + loads[i].strain;
      out.tension = std::max(out.tension, loads[i].stress[0]);
      out.curvature = std::max(out.curvature, bent.tail<2>().norm());
    }
  }
  return out;
}

std::vector<Gauge> gauges_of(const AssemblyScene& scene) {
  std::vector<Gauge> out = gauges({"step", "t", "h", "contacts_found", "contacts", "iterations", "newton",
                                   "residual", "worst_island", "min_gap", "min_base_distance", "energy"});
  using F = const Frame&;
  const auto add = [&](std::string column, std::string total, GaugeTotal keep,
                       std::function<double(F)> value) {
    out.push_back({std::move(column), std::move(total), keep, std::move(value)});
  };
  add("force", "peak_force", GaugeTotal::most, [&](F f) { return pull_at(scene, f.state).force.norm(); });
  add("torque", "peak_torque", GaugeTotal::most, [&](F f) { return pull_at(scene, f.state).torque.norm(); });
  add("lag", "max_lag", GaugeTotal::most, [&](F f) { return lag_of(scene, f.state); });
  std::ranges::move(gauges({"attempts", "ms_contact", "ms_solve", "ms_certificate", "ms_total",
                            "total:solver_failures", "total:max_contacts"}),
                    std::back_inserter(out));
  add("", "peak_contact_force", GaugeTotal::most, [&](F f) { return contact_force(f, scene.moving); });
  if (!scene.cables.empty()) {
    add("tension", "peak_tension", GaugeTotal::most,
        [&](F f) { return largest_load(scene, f.state).tension; });
    add("bend_radius", "min_bend_radius", GaugeTotal::least,
        [&](F f) { return 1 / largest_load(scene, f.state).curvature; });
  }
  add("", "energy_error", GaugeTotal::sum, [](F f) { return std::abs(f.report.energy.residual()); });
  add("", "energy_scale", GaugeTotal::sum, [](F f) {
    const EnergyLedger& e = f.report.energy;
    return std::abs(e.law_work) + std::abs(e.contact_work) + std::abs(e.kinetic_change);
  });
  return out;
}

double largest_dilation(const Model& model) {
  double out = 0;
  for (const auto& shape : model.shapes) out = std::max(out, shape->radius);
  return out;
}

// True unless the part is held up or a promise is broken.
bool tell_end(const AssemblyInput& input, const AssemblyScene& scene, const DrivenRun& run, double min_gap,
              double cpu) {
  const Recording& r = run.recording;
  std::printf("%s: %s, %s, %s, pull up to %.3g N and %.3g N m, lag up to %.3g mm, up to %s, %.3g s CPU\n",
              input.name.c_str(), counted_noun(r.steps(), "step").c_str(), gap_text(min_gap).c_str(),
              distance_text(r.total("min_base_distance")).c_str(), r.total("peak_force"),
              r.total("peak_torque"), 1e3 * r.total("max_lag"),
              counted_noun(std::int64_t(r.total("max_contacts")), "contact").c_str(), cpu);
  const double arrival = kArrival * scene.radius + std::abs(scene.misalignment),
               lag = lag_of(scene, run.state);
  if (lag > arrival)
    std::fprintf(stderr,
                 "the part did not arrive: %.4g mm behind the end of its path, more than %.4g mm; its weight "
                 "of %.4g N alone pulls it up to %.4g mm off the path (--frequency = %.4g Hz)\n",
                 1e3 * lag, 1e3 * arrival, scene.model.bodies[scene.moving].mass * scene.model.gravity.norm(),
                 1e3 * scene.sag, scene.frequency);
  return print_findings(r.totals(), scene.model) && lag <= arrival && run.last.moved() &&
         r.total("solver_failures") == 0 && r.total("min_base_distance") > 0 &&
         min_gap >= -kLargestOverlap * 2 * largest_dilation(scene.model);
}

ExitCode replay_dynamic(const AssemblyInput& input, const AssemblyScene& scene, const Arguments& a) {
  const State start = start_of(scene);
  RunPlan plan{.driver = "replay_assembly",
               .name = input.name,
               .h = scene.h,
               .t_end = scene.path.t.back() + a.parts.scene.hold,
               .scene = scene_text(*a.cli, input.fingerprint,
                                   {"--data", "--fixed", "--moving", "--path", "--cache", "--flexible"}),
               .header = header_of(input, scene, a),
               .gauges = gauges_of(scene),
               .pull = [&](const State& state) { return pull_at(scene, state); }};
  if (!a.run.common.quiet)
    std::printf("%s to take, more if some are shortened\n",
                counted_noun(std::int64_t(std::ceil(plan.t_end / scene.h - 1e-9)), "step").c_str());
  std::fflush(stdout);
  const DrivenRun run = drive(scene.model, start, std::move(plan), a.run);
  if (run.interrupted) return ExitCode::interrupted;
  const Recording& r = run.recording;
  const MoreauJean looks(scene.model, {.threads = a.run.common.threads}, {.theta = 1});
  const double at_end = smallest_gap(looks.contacts(run.state, 2 * scene.clearance));
  const double min_gap = std::min(r.total("min_gap"), at_end), cpu = r.cpu_seconds();
  Summary summary = summary_of(input, scene, a);
  set_run(run, summary);
  summary.set("min_gap", min_gap);
  summary.set("scheme", run.scheme);
  summary.set("options", run.options);
  summary.set("refused_steps", std::int64_t(run.last.status == StepStatus::refused));
  summary.set("energy_residual",
              r.total("energy_scale") > 0 ? r.total("energy_error") / r.total("energy_scale") : 0.0);
  summary.set("final_lag", lag_of(scene, run.state));
  summary.set("cpu_s", cpu);
  write(summary, a);
  return tell_end(input, scene, run, min_gap, cpu) ? ExitCode::ok : ExitCode::not_accepted;
}

// A kinematic replay takes no steps, solves nothing and writes no checkpoint.
void refuse_unread_by_mode(const Cli& cli, bool dynamic) {
  if (dynamic) return refuse_given(cli, {"--threshold"}, "--mode kinematic");
  std::vector<std::string> unread = {
      "--mu",    "--restitution",      "--density", "--mass",          "--gravity", "--h",
      "--every", "--checkpoint-every", "--resume",  "--resume-anyway", "--flexible"};
  for (const char* group : {"path", "scheme", "solver", "run", "problems"})
    for (const std::string& flag : cli.given(group)) unread.push_back(flag);
  refuse_given(cli, unread, "--mode dynamic");
}

void lay(const std::filesystem::path& file, const std::vector<RoutedCable>& cables, AssemblyScene& scene) {
  try {
    lay_cables(cables, scene);
    validate_start(scene.model, start_of(scene));
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(file.string() + ": " + wrong.what());
  }
}

ExitCode replay(Arguments& a) {
  const bool dynamic = a.mode == "dynamic";
  refuse_unread_by_mode(*a.cli, dynamic);
  check(*a.cli, a.run);
  take(a.said, a.parts.scene);
  a.parts.scene.gravity = vector_of(a.parts.gravity, "--gravity");
  a.parts.scene.levels = scheme_options(a.run.scheme).step.levels;
  AssemblyInput input = read_input(a.parts);
  std::vector<RoutedCable> cables;
  if (!a.flexible.empty()) {
    const std::string text = read_file(a.flexible);
    cables = cables_in(text, a.flexible.string(), {input.fixed.name, input.moving.name});
    input.fingerprint += ' ' + std::to_string(fingerprint_of(text));
  }
  AssemblyScene scene;
  {
    Progress progress("clearance", double(input.poses.size()), Progress::style_of_stderr(a.run.common.quiet));
    scene =
        make_assembly_scene(input, a.parts.scene, a.run.common.threads, [&](int i, int) { progress.at(i); });
  }
  if (!cables.empty()) lay(a.flexible, cables, scene);
  note_straightened(input.fixed, shape_of(scene, scene.fixed));
  note_straightened(input.moving, shape_of(scene, scene.moving));
  print_parts(input, scene, a);
  make_folders(a.run.common);
  return a.mode == "kinematic" ? replay_kinematic(input, scene, a) : replay_dynamic(input, scene, a);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  // Below theta = 1 a coupling that is stiff for the step gives energy through contacts that open (LED-5).
  start_from_theta(a.run.scheme.options, 1);
  a.run.scheme.left_out.clear();
  Cli cli("replay_assembly", "Replays a recorded assembly path of two parts, with all their contacts.");
  cli.group("scene");
  add_parts(cli, a.parts);
  cli.input("--flexible", a.flexible,
            "JSON file of cables held by the parts and routed through clips; see "
            "doc/howto/route_a_cable.md");
  cli.choice("--mode", a.mode,
             "dynamic: pull the part along by a spring; kinematic: find contacts at the recorded poses",
             {"dynamic", "kinematic"});
  const std::vector<OfferedSetting> scene = offered(a.parts.scene, a.said);
  add_flags(cli, scene, a.said, {"--dilation", "--mu", "--restitution", "--density", "--mass"});
  cli.stands_for("--restitution", "ContactLaw::restitution");
  add_gravity(cli, a.parts, "oblique by default, so that the part leans on it");
  cli.group("path");
  add_flags(cli, scene, a.said,
            {"--speed", "--misalignment", "--frequency", "--damping-ratio", "--force-limit", "--torque-limit",
             "--hold"});
  cli.group("stepping");
  add_flags(cli, scene, a.said, {"--stride", "--h"});
  cli.option("--threshold", a.threshold,
             "with --mode kinematic: largest gap of a contact; 0: twice the smallest clearance", "m", {0, 1});
  add_run_options(cli, a.run);
  a.cli = &cli;
  cli.example("replay_assembly --builtin bolt_nut -o out", "a nut turned off its bolt; open out/replay.html");
  cli.example(
      "replay_assembly --fixed rail.obj --moving slider.obj --path out.csv --scale 1e-3 -o out --summary "
      "out/s.json",
      "files in millimetres");
  cli.example(
      "replay_assembly --fixed socket.obj --moving peg.obj --path peg_out.csv --flexible lead.json -o out",
      "with a cable from the peg to the socket");
  return run_driver(cli, argc, argv, [&] { return replay(a); });
}
