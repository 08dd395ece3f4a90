// SPDX-License-Identifier: Apache-2.0
// A session of a hand with two parts, in the browser or by a script: it takes one, leads it by a spring, goes
// back, changes friction, lets go. What it does is kept, and repeated with the same bits by assess_path.
//
// Theory   doc/theory/sessions.md (SES-1) to (SES-3), doc/theory/ports.md
// Run      assembly_station --builtin bolt_nut --demo-script --no-browser
// Expect   no refused tick; assess_path --session out/session.h5 finds the same hashes
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/drivers/assembly/assess_report.hpp"
#include "examples/drivers/station/hand_script.hpp"
#include "examples/drivers/station/station_setup.hpp"
#include "geometry/check.hpp"
#include "io/build_info.hpp"
#include "io/record.hpp"
#include "io/session_writer.hpp"
#include "io/text.hpp"
#include "ports/simulated_hand.hpp"
#include "station/device_loop.hpp"
#include "station/live_session.hpp"
#include "station/server.hpp"
#include "station/spacenav.hpp"
#include "station/take_reader.hpp"

using namespace aussois;

namespace {

// Across the path until it hits, back, along the path, without friction, and off.
std::vector<HandCommand> demo_commands(const AssemblyScene& scene) {
  using Kind = HandCommand::Kind;
  const Trajectory& path = scene.path;
  const SE3 begin = path.pose.front();
  const double time = std::min(0.5, path.t.back());
  const SE3 there = trajectory_point(path, time).pose;
  const Vec3 along = there.p - begin.p;
  const Vec3 aside = along.isZero(1e-12) ? Vec3::UnitX() : Vec3(along.unitOrthogonal());
  std::vector<HandCommand> out{{.kind = Kind::grab},
                               {.kind = Kind::wait, .time = 0.2},
                               {.kind = Kind::move, .time = 0.3, .by = 4 * scene.clearance * aside},
                               {.kind = Kind::wait, .time = 0.1},
                               {.kind = Kind::mark, .text = "pushed against the other part"},
                               {.kind = Kind::seek, .time = 0.4},
                               {.kind = Kind::set, .text = "mu", .value = 0}};
  SE3 from = begin;
  constexpr int kPieces = 8;
  for (int k = 1; k <= kPieces; ++k) {
    const SE3 to = trajectory_point(path, time * k / kPieces).pose;
    out.push_back({.kind = Kind::move,
                   .time = time / kPieces,
                   .by = to.p - from.p,
                   .turn = log_so3(to.R * from.R.conjugate())});
    from = to;
  }
  out.push_back({.kind = Kind::mark, .text = "led along the path"});
  out.push_back({.kind = Kind::release, .time = 0.2});
  return out;
}

RunHeader header_of(const SessionStage& stage, const Station& station, const std::string& line) {
  RunHeader out = run_header(stage.model());
  out.title = "assembly_station " + station.input.name;
  out.command_line = line;
  return out;
}

// What was played, and its end on the disk.
struct Played {
  SessionLog log{};
  int take = 0;
  bool whole = true;
};
Played play_to_file(const Station& station, const std::vector<HandCommand>& commands,
                    const std::map<std::string, std::string>& notes, const StationArguments& a) {
  Session session(station.make, station.parameters, station.options);
  SessionWriter writer(a.common.out / "session.h5", notes);
  Progress progress("session", duration(commands), Progress::style_of_stderr(a.common.quiet));
  Played out;
  out.whole = play(commands, session, [&](const TickReport&) {
    if (session.moment() % Session::kBlock == 0) writer.write(session.log());
    progress.at(session.state().t);
    return !interrupted();
  });
  session.add_hash();
  writer.write(session.log());
  writer.close();
  out.log = session.log();
  out.take = session.take();
  return out;
}

std::vector<HandCommand> commands_of(const Station& station, const StationArguments& a) {
  if (a.demo_script) return demo_commands(station.scene);
  return hand_commands_in(read_file(a.script), a.script.string());
}

// Writes run, page and path of a take, repeated on the way.
TakeAssessment assess(const Station& station, const SessionLog& log, int take, const StationArguments& a,
                      const std::string& line, const std::function<bool(std::int64_t)>& go_on) {
  SessionStage stage(station.make, station.parameters, station.options);
  TakeAssessment done = assess_take(log, take, stage, header_of(stage, station, line),
                                    {.folder = a.common.out,
                                     .every = a.common.every,
                                     .radius = station.scene.radius,
                                     .clearance = station.scene.clearance,
                                     .go_on = go_on});
  write_report(a.common.out, done, {},
               {.title = station.input.name + ", take " + std::to_string(take),
                .command_line = line,
                .build = build_info(),
                .marks = TakeReader(log, take).marks(),
                .tick = station.parameters.tick});
  return done;
}

ExitCode tell_end(const Station& station, const SessionLog& log, int take, const TakeAssessment& done,
                  const StationArguments& a) {
  for (const SessionMark& mark : log.marks)
    std::printf("take %d, tick %lld: %s: %s\n", mark.take, static_cast<long long>(mark.moment),
                mark.kind.c_str(), mark.text.c_str());
  std::printf("%s, take %d: %s\n", station.input.name.c_str(), take, to_string(done).c_str());
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("pair", station.input.name);
    summary.set("takes", std::int64_t(log.takes.size()));
    summary.set("marks", std::int64_t(log.marks.size()));
    set_assessment(done, summary);
    write_summary(a.common.summary, summary);
  }
  return done.repeat.differs < 0 && done.refused == 0 && done.unsolved == 0 ? ExitCode::ok
                                                                            : ExitCode::not_accepted;
}

ExitCode play_script(const Station& station, const StationArguments& a, int argc, const char* const* argv) {
  const std::vector<HandCommand> commands = commands_of(station, a);
  const Played played = play_to_file(station, commands, station_notes(station, argc, argv), a);
  if (!played.whole) return ExitCode::interrupted;
  const TakeAssessment done = assess(station, played.log, played.take, a, command_line(argc, argv),
                                     [](std::int64_t) { return !interrupted(); });
  return interrupted() ? ExitCode::interrupted : tell_end(station, played.log, played.take, done, a);
}

void open_in_browser(const std::string& address) {
  if (std::system(("xdg-open '" + address + "' >/dev/null 2>&1 &").c_str()) != 0)
    std::fprintf(stderr, "cannot open a browser: open the address by hand\n");
}

// Pushes across the path, into what is there and back.
Reaching reaching_of(const Station& station) {
  const Trajectory& path = station.scene.path;
  const Vec3 along = path.pose.back().p - path.pose.front().p;
  const double clearance = station.scene.clearance;
  return {.home = path.pose.front(),
          .into = along.isZero(1e-12) ? Vec3::UnitX() : Vec3(along.unitOrthogonal()),
          .shallow = 2 * clearance,
          .deep = 10 * clearance,
          .back = 0.5 * clearance};
}

HapticDevice device_named(const std::string& name, const Station& station) {
  const std::string simulated = "simulated:";
  require(name.starts_with(simulated), "--device " + name +
                                           " must be simulated:HAND; devices of makers go behind "
                                           "the four functions of ports/device.hpp");
  return simulated_device(value_named(name.substr(simulated.size()), "--device", kHandKinds), {},
                          reaching_of(station), 1);
}

// A space mouse on its thread.
class SpaceMouse {
 public:
  SpaceMouse(LiveSession& live, const Vec3& grip)
      : thread_([this, &live, grip] {
          try {
            while (!stop_)
              for (const SpacenavEvent& event : mouse_.read(0.1)) {
                if (event.kind == SpacenavEvent::Kind::motion)
                  live.hand(command_of(event, grip), LiveSession::From::space_mouse);
                if (event.kind == SpacenavEvent::Kind::press) live.let_go();
              }
          } catch (const std::runtime_error& gone) {
            std::fprintf(stderr, "%s\n", gone.what());
          }
        }) {}
  ~SpaceMouse() {
    stop_ = true;
    thread_.join();
  }

 private:
  Spacenav mouse_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

void tell_device(const DeviceRecord& record) {
  std::printf(
      "device: %lld samples, %lld late, %lld jumps, forces up to %.3g N; the reserve scaled %lld and "
      "stopped %lld%s\n",
      static_cast<long long>(record.samples), static_cast<long long>(record.late),
      static_cast<long long>(record.jumps), record.largest_force,
      static_cast<long long>(record.reserve.scaled), static_cast<long long>(record.reserve.stopped),
      record.lost.empty() ? "" : ("; " + record.lost).c_str());
}

// Until a page says stop or Ctrl-C. The take of the last tick is then repeated and written.
ExitCode serve_pages(const Station& station, const StationArguments& a, int argc, const char* const* argv) {
  const std::filesystem::path file = a.common.out / "session.h5";
  const std::string line = command_line(argc, argv);
  std::atomic<bool> ends = false;
  const auto save = [&](const SessionLog& log, int take) {
    const TakeAssessment done = assess(station, log, take, a, line, [&](std::int64_t) { return !ends; });
    return "session.h5, run.h5, replay.html, path.csv; " + to_string(done);
  };
  {
    LiveSession live(Session(station.make, station.parameters, station.options),
                     {.title = station.input.name,
                      .file = file,
                      .notes = station_notes(station, argc, argv),
                      .hold = !a.fall,
                      .save = save});
    Server server(live, {.address = a.bind, .port = a.port});
    std::printf("%s\n", server.address().c_str());
    std::fflush(stdout);
    if (a.open) open_in_browser(server.address());
    std::optional<DeviceLoop> device;
    std::optional<SpaceMouse> mouse;
    if (!a.device.empty()) device.emplace(live, device_named(a.device, station));
    if (a.spacenav) mouse.emplace(live, inverse(station.scene.model.bodies[station.scene.moving].g_bs).p);
    if (device || mouse) live.begin();
    const auto begin = std::chrono::steady_clock::now();
    server.run([&] {
      const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
      return !interrupted() && (a.seconds == 0 || since.count() < a.seconds);
    });
    ends = true;
    if (device) tell_device(device->record());
    device.reset();
    mouse.reset();
    live.end();
    if (live.failed()) throw std::runtime_error("the session ended: " + live.failure());
  }
  const SessionData session = read_session(file);
  const int take = int(session.log.takes.size()) - 1;
  const TakeAssessment done = assess(station, session.log, take, a, line, {});
  return tell_end(station, session.log, take, done, a);
}

ExitCode serve(const StationArguments& a, const Cli& cli, int argc, const char* const* argv) {
  const bool script = !a.script.empty() || a.demo_script;
  require(a.script.empty() || !a.demo_script, "--script and --demo-script exclude each other");
  require(script == a.no_browser, "--no-browser and a script (--script, --demo-script) need each other");
  require(a.bind == "127.0.0.1" || a.no_tls_is_known, "--bind " + a.bind + " needs --i-know-there-is-no-tls");
  StationArguments chosen = a;
  use_passive_scheme(cli, chosen);
  const Station station = set_up(chosen.station, a.common.threads, a.common.quiet);
  make_folders(a.common);
  print_warnings(station.input, station.scene);
  if (!a.common.quiet) std::printf("%s\n", to_string(station).c_str());
  std::fflush(stdout);
  return script ? play_script(station, a, argc, argv) : serve_pages(station, a, argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  StationArguments a;
  a.common.threads = ManyTasks::all_cores();
  Cli cli("assembly_station",
          "Takes a part in hand: a session that is kept, and repeated with the same bits.");
  add_options(cli, a);
  cli.example("assembly_station --builtin bolt_nut --open -o out",
              "a nut on its bolt in the browser; the session is in out/session.h5");
  cli.example("assembly_station --builtin bolt_nut --demo-script --no-browser -o out",
              "a scripted hand with a nut on its bolt; open out/replay.html");
  cli.example(
      "assembly_station --fixed rail.obj --moving slider.obj --path out.csv --script hand.json --no-browser "
      "-o out",
      "files in millimetres; the part starts at the first pose of the path");
  return run_driver(cli, argc, argv, [&] { return serve(a, cli, argc, argv); });
}
