// SPDX-License-Identifier: Apache-2.0
// Repeats a take of a session without a clock, or leads a part along a recorded path by a hand, and says what
// came of it: whether it arrived, what it cleared, what forces it took.
//
// Theory   doc/theory/sessions.md (SES-1) to (SES-3), doc/theory/ports.md
// Run      assess_path --fixed data/socket.obj --moving data/peg.obj --path data/peg_out.csv --misalignment 1
// Expect   exit code 0: the part arrives; with --session every hash is the same
#include <algorithm>
#include <cstdio>

#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/drivers/assembly/assess_report.hpp"
#include "examples/drivers/assembly/clearance_map.hpp"
#include "examples/drivers/assembly/swept_volume.hpp"
#include "examples/drivers/station/path_sweep.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/record.hpp"
#include "station/take_reader.hpp"

using namespace aussois;

namespace {

struct Arguments {
  StationFlags station{};
  std::filesystem::path session{};
  int take = -1;      // -1: the last
  double hold = 0.1;  // at the end of a path [s]
  AssessBounds bounds{};
  bool map = false;
  int swept = 0;  // cells along the longest side; 0: not asked for
  SweepFlags sweep{};
  CommonOptions common{};
};

struct Task {
  Station station{};
  SessionLog log{};
  int take = 0;
  std::optional<TakeGoal> goal{};
  std::string program{};  // that wrote the session
};

Task session_task(const Arguments& a) {
  SessionData session = read_session(a.session);
  Task out{.station = set_up_again(session.notes, a.session, a.common.threads, a.common.quiet),
           .log = std::move(session.log),
           .take = a.take};
  if (out.take < 0) out.take = int(out.log.takes.size()) - 1;
  out.program = session.notes["program"];
  return out;
}

Task path_task(const Arguments& a) {
  Task out{.station = set_up(a.station, a.common.threads, a.common.quiet)};
  out.log = log_of_path(out.station, a.hold);
  const AssemblyScene& scene = out.station.scene;
  out.goal = TakeGoal{.pose = scene.path.pose.back(), .tolerance = kArrival * scene.radius};
  return out;
}

bool meets(const TakeAssessment& done, const Arguments& a) {
  const bool there = done.verdict == TakeVerdict::arrived || done.verdict == TakeVerdict::ended;
  return there && done.clearance >= a.bounds.clearance_min &&
         std::max(done.hand_force, done.contact_force) <= a.bounds.force_max;
}

ExitCode verdict_of(const TakeAssessment& done, const Task& task, const Arguments& a) {
  if (done.repeat.differs >= 0)
    std::fprintf(stderr,
                 "the session differs at tick %lld, the first with another hash; it was written by %s\n",
                 static_cast<long long>(done.repeat.differs), task.program.c_str());
  const bool clears = done.clearance >= a.bounds.clearance_min,
             light = std::max(done.hand_force, done.contact_force) <= a.bounds.force_max;
  if (!clears)
    std::fprintf(stderr, "the parts come nearer than %.4g m: %.4g m\n", a.bounds.clearance_min,
                 done.clearance);
  if (!light) std::fprintf(stderr, "a force exceeds %.4g N\n", a.bounds.force_max);
  return done.repeat.differs < 0 && meets(done, a) ? ExitCode::ok : ExitCode::not_accepted;
}

// What results depend on, besides the content of files.
std::string said_of(const Cli& cli) {
  std::string out;
  for (const char* group : {"scene", "hand", "scheme", "solver"}) out += cli.values(group);
  return out;
}

// A row for each path and each combination of values.
ExitCode assess_many(const Arguments& a, const Cli& cli) {
  refuse_given(cli, {"--every", "--map", "--swept"}, "one path");
  const std::vector<SweepAxis> axes = sweep_axes(a.sweep.sweeps);
  const std::optional<std::vector<SweepRow>> rows = assess_all({.station = a.station,
                                                                .sweep = a.sweep,
                                                                .hold = a.hold,
                                                                .said = said_of(cli),
                                                                .out = a.common.out,
                                                                .threads = a.common.threads,
                                                                .quiet = a.common.quiet});
  if (!rows) return ExitCode::interrupted;
  std::int64_t good = 0;
  for (const SweepRow& row : *rows) {
    good += row.problem.empty() && meets(row.assessment, a);
    if (a.common.quiet) continue;
    std::string name = row.path.filename().string();
    for (std::size_t i = 0; i < axes.size(); ++i)
      name += (name.empty() ? "" : " ") + axes[i].name + "=" + number_text(row.values[i]);
    std::printf("%s: %s\n", name.c_str(),
                (row.problem.empty() ? to_string(row.assessment) : "not assessed: " + row.problem).c_str());
  }
  write_whole_file(a.common.out / "assessments.csv", csv_of(axes, *rows));
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("rows", std::int64_t(rows->size()));
    summary.set("good", good);
    write_summary(a.common.summary, summary);
  }
  std::printf("%lld of %s meet what is asked\n", static_cast<long long>(good),
              counted_noun(std::int64_t(rows->size()), "assessment").c_str());
  return good == std::int64_t(rows->size()) ? ExitCode::ok : ExitCode::not_accepted;
}

// What the part came near to, and what it swept. Distances are told apart up to ten clearances.
void write_maps(const Station& station, const TakeAssessment& done, const Arguments& a, Summary& summary) {
  const SimplicialComplex& part = station.input.moving.complex;
  if (a.map) {
    const LmdShape moving = prepare({.complex = part, .radius = 0}),
                   fixed = prepare({.complex = station.input.fixed.complex, .radius = 0});
    const double cutoff = 10 * station.scene.clearance;
    ClearanceMapper mapper(moving, fixed, cutoff, a.common.threads);
    for (const SE3& g : done.way) mapper.add(g);
    write_clearance_ply(a.common.out / "clearance.ply", moving.complex, mapper.map(), cutoff);
    summary.set("map_least", *std::ranges::min_element(mapper.map().distance));
    summary.set("map_between", mapper.map().between);
  }
  if (a.swept > 0) {
    const SweptVolume swept = swept_volume(part, done.way, a.swept, a.common.threads);
    write_swept_obj(a.common.out / "swept.obj", swept);
    summary.set("swept_volume", swept.volume);
    summary.set("swept_error", swept.error);
  }
}

ExitCode assess(const Arguments& a, const Cli& cli, const std::string& line) {
  if (a.session.empty()) refuse_given(cli, {"--take"}, "--session");
  if (!a.sweep.any()) refuse_given(cli, {"--shard"}, "--sweep or --paths");
  if (a.sweep.any()) {
    require(a.session.empty(), "--sweep and --paths need parts and a path, no --session");
    return assess_many(a, cli);
  }
  Task task = a.session.empty() ? path_task(a) : session_task(a);
  make_folders(a.common);
  const Station& station = task.station;
  print_warnings(station.input, station.scene);
  if (!a.common.quiet) std::printf("%s\n", to_string(station).c_str());
  SessionStage stage(station.make, station.parameters, station.options);
  RunHeader header = run_header(stage.model());
  header.title = "assess_path " + station.input.name;
  header.command_line = line;
  header.build = build_info();
  require_field(task.take < int(task.log.takes.size()), "--take", task.take,
                ("be less than the number of takes, " + std::to_string(task.log.takes.size())).c_str());
  Progress progress("assess_path", double(task.log.takes[std::size_t(task.take)].ends),
                    Progress::style_of_stderr(a.common.quiet));
  const TakeAssessment done = assess_take(task.log, task.take, stage, header,
                                          {.folder = a.common.out,
                                           .every = a.common.every,
                                           .radius = station.scene.radius,
                                           .clearance = station.scene.clearance,
                                           .goal = task.goal,
                                           .go_on = [&](std::int64_t tick) {
                                             progress.at(double(tick + 1));
                                             return !interrupted();
                                           }});
  if (interrupted()) return ExitCode::interrupted;
  Summary summary;
  summary.set("pair", station.input.name);
  summary.set("take", std::int64_t(task.take));
  set_assessment(done, summary);
  write_maps(station, done, a, summary);
  write_summary(a.common.out / "assessment.json", summary);
  write_report(a.common.out, done, a.bounds,
               {.title = station.input.name + (task.goal ? "" : ", take " + std::to_string(task.take)),
                .command_line = line,
                .build = build_info(),
                .marks = TakeReader(task.log, task.take).marks(),
                .tick = station.parameters.tick});
  if (!a.common.summary.empty()) write_summary(a.common.summary, summary);
  if (task.goal)
    std::printf("%s: %s, %.4g mm off its goal\n", station.input.name.c_str(), to_string(done).c_str(),
                1e3 * done.lag);
  else
    std::printf("%s, take %d: %s; %s the same\n", station.input.name.c_str(), task.take,
                to_string(done).c_str(),
                done.repeat.differs < 0 ? (std::to_string(done.repeat.hashes) + " hashes").c_str()
                                        : "not all hashes");
  return verdict_of(done, task, a);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.common.threads = ManyTasks::all_cores();
  Cli cli("assess_path", "Leads a part along a path, or repeats a session, and says whether it gets there.");
  add_options(cli, a.station);
  cli.group("assessment");
  add_flags(cli, a.station.parts.scene, a.station.said, {"--misalignment"});
  cli.input("--session", a.session, "session.h5 of assembly_station instead of parts and a path");
  cli.option("--take", a.take, "of the session; -1: the last", "", range_from(-1));
  cli.option("--hold", a.hold, "time to hold the part at the end of the path", "s", {0, 1e4});
  cli.option("--clearance-min", a.bounds.clearance_min, "distance of the meshes that is asked for", "m",
             {0, 1});
  cli.option("--clearance-max", a.bounds.clearance_max,
             "distance above which the report counts the time apart", "m", range_above(0));
  cli.option("--force-max", a.bounds.force_max, "largest force of hand and contacts that is allowed", "N",
             range_above(0));
  cli.flag("--map", a.map, "write clearance.ply, the least distance of each vertex of the part over its way");
  cli.option("--swept", a.swept, "write swept.obj, what the part sweeps, on a grid of so many cells; 0: none",
             "", {0, 512});
  add_options(cli, a.sweep);
  cli.option("--every", a.common.every, "record each n-th tick", "", range_from(1));
  cli.common(a.common);
  cli.example("assess_path --builtin bolt_nut -o out", "a nut led along its path by a hand");
  cli.example("assess_path --builtin bolt_nut --sweep mu=0,0.2 --sweep misalignment=0,1 -o out",
              "four assessments on all cores, and a table");
  cli.example("assess_path --session out/session.h5 -o again", "the last take of a session, bit for bit");
  return run_driver(cli, argc, argv, [&] { return assess(a, cli, command_line(argc, argv)); });
}
