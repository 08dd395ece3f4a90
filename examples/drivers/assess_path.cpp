// SPDX-License-Identifier: Apache-2.0
// Repeats a take of a session without a clock, or leads a part along a recorded path by a hand, and says what
// came of it: whether it arrived, what it cleared, what forces it took.
//
// Theory   doc/theory/sessions.md (SES-1) to (SES-3), doc/theory/ports.md
// Run      assess_path --fixed data/socket.obj --moving data/peg.obj --path data/peg_out.csv --misalignment 1
// Expect   exit code 0: the part arrives; with --session every hash is the same
#include <cstdio>

#include "examples/common/progress.hpp"
#include "examples/drivers/assembly/assess_take.hpp"
#include "examples/drivers/station/station_setup.hpp"
#include "geometry/check.hpp"
#include "io/build_info.hpp"
#include "io/record.hpp"

using namespace aussois;

namespace {

struct Arguments {
  StationFlags station{};
  std::filesystem::path session{};
  int take = -1;      // -1: the last
  double hold = 0.1;  // at the end of a path [s]
  double clearance_min = 0, force_max = kInf;
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

ExitCode verdict_of(const TakeAssessment& done, const Task& task, const Arguments& a) {
  if (done.repeat.differs >= 0)
    std::fprintf(stderr,
                 "the session differs at tick %lld, the first with another hash; it was written by %s\n",
                 static_cast<long long>(done.repeat.differs), task.program.c_str());
  const bool clears = done.clearance >= a.clearance_min,
             light = std::max(done.hand_force, done.contact_force) <= a.force_max;
  if (!clears)
    std::fprintf(stderr, "the parts come nearer than %.4g m: %.4g m\n", a.clearance_min, done.clearance);
  if (!light) std::fprintf(stderr, "a force exceeds %.4g N\n", a.force_max);
  const bool there = done.verdict == TakeVerdict::arrived || done.verdict == TakeVerdict::ended;
  return done.repeat.differs < 0 && there && clears && light ? ExitCode::ok : ExitCode::not_accepted;
}

ExitCode assess(const Arguments& a, const Cli& cli, const std::string& line) {
  if (a.session.empty()) refuse_given(cli, {"--take"}, "--session");
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
  write_summary(a.common.out / "assessment.json", summary);
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
  Cli cli("assess_path", "Leads a part along a path, or repeats a session, and says whether it gets there.");
  add_options(cli, a.station);
  cli.group("assessment");
  add_flags(cli, a.station.parts.scene, a.station.said, {"--misalignment"});
  cli.input("--session", a.session, "session.h5 of assembly_station instead of parts and a path");
  cli.option("--take", a.take, "of the session; -1: the last", "", range_from(-1));
  cli.option("--hold", a.hold, "time to hold the part at the end of the path", "s", {0, 1e4});
  cli.option("--clearance-min", a.clearance_min, "distance of the meshes that is asked for", "m", {0, 1});
  cli.option("--force-max", a.force_max, "largest force of hand and contacts that is allowed", "N",
             range_above(0));
  cli.option("--every", a.common.every, "record each n-th tick", "", range_from(1));
  cli.common(a.common);
  cli.example("assess_path --builtin bolt_nut -o out", "a nut led along its path by a hand");
  cli.example("assess_path --session out/session.h5 -o again", "the last take of a session, bit for bit");
  return run_driver(cli, argc, argv, [&] { return assess(a, cli, command_line(argc, argv)); });
}
