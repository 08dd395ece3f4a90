// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/station/station_setup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <sstream>

#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "io/build_info.hpp"
#include "io/shape_cache.hpp"
#include "mechanics/handle.hpp"

namespace aussois {
namespace {

constexpr double kForce = 100, kTorque = 5, kSpeed = 0.01;  // of a hand, unless told [N], [N m], [m/s]

// What all scenes of a session share.
struct Parts {
  AssemblyPart fixed{}, moving{};
  AssemblyScene scene{};
  LmdShapeOptions options{};
  std::filesystem::path cache{};

  struct Dilated {
    std::shared_ptr<const LmdShape> fixed{}, moving{};
  };
  mutable std::mutex mutex{};
  mutable std::map<double, Dilated> known{};  // by dilation: they take long

  Dilated dilated(double radius) const {
    const std::lock_guard lock(mutex);
    const auto prepared = [&](const AssemblyPart& part) {
      return prepare_cached({.complex = part.complex, .radius = radius}, options, cache).shape;
    };
    Dilated& out = known[radius];
    if (!out.fixed) out = {prepared(fixed), prepared(moving)};
    return out;
  }

  Model model(const SessionParameters& p) const {
    Model out = scene.model;
    out.forces.clear();  // the hand pulls, and not the path
    out.gravity = p.gravity;
    out.contact_law = {.mu = p.mu, .restitution = p.restitution};
    if (p.dilation != scene.dilation) {
      const Dilated shapes = dilated(p.dilation);
      out.shapes[out.bodies[scene.fixed].shape] = shapes.fixed;
      out.shapes[out.bodies[scene.moving].shape] = shapes.moving;
    }
    return out;
  }
};

SessionMaker maker_of(const std::shared_ptr<const Parts>& parts) {
  return [parts](const SessionParameters& p) {
    SessionScene out{.model = parts->model(p)};
    out.port = add_port(out.model, parts->scene.moving, p.port);
    out.start = rest_state(out.model);
    pose(out.start, parts->scene.moving) = parts->scene.path.pose.front();
    return out;
  };
}

// The largest of 1, 2, 5, 10 ms that is not longer; at least the first.
double usual_tick(double h) {
  double tick = kTicks.lowest;
  for (const double next : {2e-3, 5e-3, kTicks.highest})
    if (next <= h) tick = next;
  return tick;
}

SessionParameters parameters_of(const StationFlags& flags, const AssemblyScene& scene) {
  const AssemblyOptions& o = flags.parts.scene;
  const RigidBody& body = scene.model.bodies[scene.moving];
  const CriticalDampers dampers =
      critical_dampers(body, scene.coupling.stiffness, scene.coupling.rotation_stiffness);
  SessionParameters out{.tick = flags.tick > 0 ? flags.tick : usual_tick(scene.h),
                        .mu = o.mu,
                        .restitution = o.restitution,
                        .gravity = scene.model.gravity,
                        .dilation = scene.dilation};
  out.port.gains = {.stiffness = scene.coupling.stiffness,
                    .damping = o.damping_ratio * dampers.translation,
                    .rotation_stiffness = scene.coupling.rotation_stiffness,
                    .rotation_damping = o.damping_ratio * dampers.rotation};
  out.port.limits = {.force = o.force_limit, .torque = o.torque_limit};
  out.port.stride = o.stride;
  return out;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(line);
  return out;
}

// The process works in another folder meanwhile.
class WorkingFolder {
 public:
  explicit WorkingFolder(const std::filesystem::path& folder) {
    std::error_code missing;
    std::filesystem::current_path(folder, missing);
  }
  ~WorkingFolder() {
    std::error_code ignored;
    std::filesystem::current_path(before_, ignored);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

const std::string& note(const std::map<std::string, std::string>& notes, const char* name,
                        const std::filesystem::path& file) {
  const auto found = notes.find(name);
  if (found == notes.end()) throw std::runtime_error(file.string() + ": has no note '" + name + "'");
  return found->second;
}

}  // namespace

StationFlags::StationFlags() {
  parts.gravity = "0,0,0";
  parts.scene.misalignment = 0;
  parts.scene.speed = kSpeed;
  parts.scene.force_limit = kForce, parts.scene.torque_limit = kTorque;
  start_from_theta(scheme.options, 1);  // as a path replayed (LED-5)
  scheme.left_out.clear();
}

void add_options(Cli& cli, StationFlags& a) {
  cli.group("scene");
  add_parts(cli, a.parts);
  const std::vector<OfferedSetting> scene = offered(a.parts.scene, a.said);
  add_flags(cli, scene, a.said, {"--dilation", "--mu", "--restitution", "--density", "--mass"});
  cli.stands_for("--restitution", "ContactLaw::restitution");
  add_gravity(cli, a.parts, "a part that nobody holds falls");
  cli.group("hand");
  add_flags(cli, scene, a.said,
            {"--frequency", "--damping-ratio", "--force-limit", "--torque-limit", "--stride", "--speed"});
  cli.option("--tick", a.tick,
             "time for which the input of the hand is constant; 0: 1, 2, 5 or 10 ms, not more than --stride "
             "allows at "
             "--speed",
             "s", or_zero(setting_of<SessionParameters>("tick").range));
  add_options(cli, a.scheme);
}

void add_options(Cli& cli, StationArguments& a) {
  add_options(cli, a.station);
  cli.group("session");
  cli.input("--script", a.script, "JSON file of what a hand does; see doc/howto/assemble_by_hand.md");
  cli.flag("--demo-script", a.demo_script,
           "a hand grabs the part, pushes it against the other, goes back, leads it on, and lets go");
  cli.flag("--no-browser", a.no_browser, "play the script, save and end");
  cli.flag("--open", a.open, "open the page in the browser of this desktop");
  cli.flag("--fall", a.fall, "a part that is let go is free; otherwise it stays where it is");
  cli.option(
      "--device", a.device,
      "haptic device that leads the part: simulated:soft, or another hand (loose, firm, rigid, shaking); the "
      "scheme is then passive_midpoint, unless told");
  cli.flag("--spacenav", a.spacenav, "a space mouse leads the part, by the daemon spacenavd");
  cli.option("--seconds", a.seconds,
             "end after this time of the clock; 0: when a page says so, or with Ctrl-C", "s", {0, 1e6});
  cli.option("--port", a.port, "where the page is served; 0: one that is free", "", {0, 65535});
  cli.option("--bind", a.bind, "address of this machine at which the page is served");
  cli.flag("--i-know-there-is-no-tls", a.no_tls_is_known,
           "allow another --bind than 127.0.0.1: what is sent can be read on the way");
  cli.option("--every", a.common.every, "record each n-th tick", "", range_from(1));
  cli.common(a.common);
}

std::string to_string(const Station& station) {
  char text[300];
  const PortOptions& port = station.parameters.port;
  std::snprintf(
      text, sizeof text,
      "clearance %.4g um, dilation %.4g um each, moving part %.4g kg (%s), ticks of %.4g ms, spring %.4g "
      "N/m and %.4g N m/rad, pull up to %.4g N and %.4g N m",
      1e6 * station.scene.clearance, 1e6 * station.parameters.dilation,
      station.scene.model.bodies[station.scene.moving].mass, station.scene.mass_source.c_str(),
      1e3 * station.parameters.tick, port.gains.stiffness, port.gains.rotation_stiffness, port.limits.force,
      port.limits.torque);
  return text;
}

void use_passive_scheme(const Cli& cli, StationArguments& a) {
  if (!a.device.empty() && !cli.is_given("--scheme")) a.station.scheme.scheme = "passive_midpoint";
}

Station set_up(const StationFlags& flags, int threads, bool quiet) {
  StationFlags a = flags;
  take(a.said, a.parts.scene);
  a.parts.scene.gravity = vector_of(a.parts.gravity, "--gravity");
  Station out{.input = read_input(a.parts)};
  out.options = {.scheme = a.scheme.scheme, .options = scheme_options(a.scheme)};
  out.options.options.step.threads = threads;
  a.parts.scene.levels = out.options.options.step.levels;
  const auto scene = [&] {
    Progress progress("clearance", double(out.input.poses.size()), Progress::style_of_stderr(quiet));
    return make_assembly_scene(out.input, a.parts.scene, threads, [&](int i, int) { progress.at(i); });
  };
  try {
    out.scene = scene();
  } catch (const std::runtime_error& not_free) {  // a hand may find that out; where it starts must be free
    a.parts.scene.clearance_at_start = true;
    out.scene = scene();
    out.scene.warnings.push_back(std::string(not_free.what()) + "; the clearance is that of the start");
  }
  out.parameters = parameters_of(a, out.scene);
  const auto parts = std::make_shared<Parts>();
  parts->fixed = out.input.fixed, parts->moving = out.input.moving;
  parts->scene = out.scene;
  parts->options = {.levels = a.parts.scene.levels, .threads = threads};
  parts->cache = a.parts.scene.cache;
  out.make = maker_of(parts);
  return out;
}

std::map<std::string, std::string> station_notes(const Station& station, int argc, const char* const* argv) {
  std::map<std::string, std::string> out{{"program", program_version()},
                                         {"build", build_info()},
                                         {"folder", std::filesystem::current_path().string()},
                                         {"input", station.input.fingerprint}};
  for (int i = 1; i < argc; ++i) {
    require(std::string(argv[i]).find('\n') == std::string::npos, "an argument must not have a line end");
    (out["arguments"] += argv[i]) += '\n';
  }
  return out;
}

Station set_up_again(const std::map<std::string, std::string>& notes, const std::filesystem::path& file,
                     int threads, bool quiet) {
  std::vector<std::string> arguments = lines_of(note(notes, "arguments", file));
  if (const auto script = std::ranges::find(arguments, "--script"); arguments.end() - script > 1)
    arguments.erase(script, script + 2);  // it was played
  arguments.insert(arguments.begin(), "assembly_station");
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  StationArguments again;
  Cli cli("assembly_station", "");
  add_options(cli, again);
  const WorkingFolder there(note(notes, "folder", file));  // paths are as they were said
  ExitCode code = ExitCode::ok;
  if (!cli.parse(int(argv.size()), argv.data(), code))
    throw std::runtime_error(file.string() + ": its command line cannot be followed again");
  use_passive_scheme(cli, again);
  Station out = set_up(again.station, threads, quiet);
  if (out.input.fingerprint != note(notes, "input", file))
    throw std::runtime_error(file.string() + ": the parts have changed since the session");
  return out;
}

SessionLog log_of_path(const Station& station, double hold) {
  const Trajectory& path = station.scene.target;
  const double tick = station.parameters.tick;
  const auto ticks = std::int64_t(std::ceil((path.t.back() + hold) / tick - 1e-9));
  SessionLog out{.takes = {{.ends = ticks}}};
  for (std::int64_t k = 0; k < ticks; ++k) {
    const double t = std::min(double(k + 1) * tick, path.t.back());
    out.inputs.push_back(
        {.tick = k, .target = {.mode = PortTarget::Mode::pose, .pose = trajectory_point(path, t).pose}});
    if (t == path.t.back()) break;
  }
  return out;
}

}  // namespace aussois
