// SPDX-License-Identifier: Apache-2.0
// Runs a scene used to compare rigid-body engines with Moreau-Jean or another scheme, records it, measures
// its error against exact results, and draws the bodies at the start and at the end.
//
// Theory   doc/theory/peer_scenes.md
// Run      peer_scene --time 2
//          peer_scene --mu 0.25 --time 1
//          peer_scene --scene tower --time 2
//          peer_scene --time 0.2 --certify 20
// Expect   the arch stands if its friction is above 0.3077, and falls if it is below
#include <algorithm>
#include <cstdio>

#include "examples/common/driven_run.hpp"
#include "examples/common/gnuplot.hpp"
#include "examples/scenes/peer_scenes.hpp"
#include "geometry/number_text.hpp"
#include "io/atomic_file.hpp"
#include "io/record.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string scene = "arch";
  Arch arch{};
  double tilt = 0, h = 1e-2, time = 0;  // [deg, s, s]
  const Cli* cli = nullptr;
  RunFlags run{};
  std::string command_line{};
};

constexpr double kAfterFall = 0.5;  // a run goes on so long after something fell [s]

// What a body looks like against y: the points of a closed line, x and z.
std::string outline(const PeerShape& shape, const SE3& g) {
  std::vector<Vec2> points;
  if (shape.kind == PeerShapeKind::ball) {
    for (int i = 0; i < 40; ++i) {
      const double angle = 2 * kPi * i / 40;
      points.emplace_back(g.p.x() + shape.size.x() * std::cos(angle),
                          g.p.z() + shape.size.x() * std::sin(angle));
    }
  } else {
    Vec2 centre = Vec2::Zero();
    std::vector<Vec2> all;
    for (const Vec3& x : corners(shape, 0)) {
      const Vec3 at = g * x;
      all.emplace_back(at.x(), at.z());
      centre += all.back() / 8;
    }
    // Around the centre; of two corners in one direction the outer one is enough.
    std::ranges::sort(all, {}, [&](const Vec2& x) {
      const Vec2 d = x - centre;
      return std::pair(std::atan2(d.y(), d.x()), d.squaredNorm());
    });
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i + 1 == all.size() || (all[i] - all[i + 1]).norm() > 1e-6) points.push_back(all[i]);
  }
  points.push_back(points.front());
  std::string text;
  for (const Vec2& x : points) text += std::to_string(x.x()) + " " + std::to_string(x.y()) + "\n";
  return text + "\n";
}

bool draw(const std::filesystem::path& folder, const PeerScene& scene, const State& end) {
  std::string before, after;
  for (const BodyId b : scene.bodies.ids()) {
    if (b == 0) continue;  // the ground
    const PeerShape& shape = scene.shapes[scene.bodies[b].shape];
    before += outline(shape, scene.bodies[b].g);
    after += outline(shape, end.g[b]);
  }
  write_whole_file(folder / "before.dat", before);
  write_whole_file(folder / "after.dat", after);
  write_whole_file(
      folder / "peer_scene.gp",
      "# draws peer_scene.png: gnuplot peer_scene.gp\n"
      "set terminal pngcairo size 800,480 font ',11'; set output 'peer_scene.png'\n"
      "set size ratio -1; set border 3; set tics out nomirror; set xlabel 'x [m]'; set ylabel 'z [m]'\n"
      "set xzeroaxis lt 1 lc rgb '#888888' lw 2; set style fill transparent solid 0.5\n"
      "plot 'after.dat' with filledcurves closed lc rgb '#7fa8d8' notitle, "
      "'after.dat' with lines lc rgb '#1f5fa8' title '" +
          std::to_string(end.t) + " s', 'before.dat' with lines lc rgb '#c0702a' dt 2 title 'start'\n");
  return run_gnuplot(folder, "peer_scene.gp");
}

// What the scene is judged by, so that a run that is continued is judged as one that was not stopped.
std::vector<Gauge> gauges_of(const PeerScene& scene) {
  const auto off = [&scene](const Frame& f) { return off_exact(scene, sample(f.start), sample(f.state)); };
  std::vector<Gauge> out = gauges({"step", "t", "h", "contacts", "min_gap", "energy", "residual",
                                   "worst_island", "total:max_contacts", "total:solver_failures"});
  out.push_back({"error", "worst_error", GaugeTotal::most, [off](const Frame& f) { return off(f).off; }});
  out.push_back({"", "error_sum", GaugeTotal::sum, [off](const Frame& f) { return off(f).term; }});
  out.push_back({"", "error_scale", GaugeTotal::sum, [off](const Frame& f) { return off(f).scale; }});
  out.push_back({"", "fall_time", GaugeTotal::least, [off](const Frame& f) { return off(f).fall_time; }});
  return out;
}

PeerTotals totals_of(const PeerScene& scene, const State& start, const Recording& r) {
  PeerTotals out;
  add(off_exact(scene, sample(start), sample(start)), out);
  out.samples += long(r.steps());
  out.sum += r.total("error_sum");
  out.scale += r.total("error_scale");
  out.worst = std::max(out.worst, r.total("worst_error"));
  out.fall_time = std::min(out.fall_time, r.total("fall_time"));
  return out;
}

// What came of it, for people. True: nothing is wrong.
bool tell_end(const PeerScene& scene, const Model& model, const PeerTotals& totals, const DrivenRun& run) {
  const Recording& r = run.recording;
  std::printf("peer_scene: %s, %s; error %.3g after %.3g s, %s\n", scene.name.c_str(),
              totals.fall_time < kInf
                  ? ("a body was 0.1 m off its place at " + std::to_string(totals.fall_time) + " s").c_str()
                  : "stands",
              error_of(scene, totals), run.state.t, counted_noun(r.steps(), "step").c_str());
  const auto failures = std::int64_t(r.total("solver_failures"));
  if (failures > 0)
    std::fprintf(stderr, "not solved to the tolerance: %s\n", counted_noun(failures, "step").c_str());
  return print_findings(r.totals(), model) && run.last.moved() && failures == 0;
}

void write_summary(const std::filesystem::path& path, const PeerScene& scene, const PeerTotals& totals,
                   const DrivenRun& run) {
  if (path.empty()) return;
  Summary out;
  out.set("error", error_of(scene, totals));
  out.set("scene", scene.name);
  out.set("scheme", run.scheme);
  out.set("options", run.options);
  out.set("t", run.state.t);
  set_run(run, out);
  out.set("fall_time", totals.fall_time < kInf ? totals.fall_time : -1);
  write_summary(path, out);
}

ExitCode run(const Arguments& a) {
  // 1. The scene.
  Arch arch = a.arch;
  arch.tilt = a.tilt * kPi / 180;
  const PeerScene scene = a.scene == "arch" ? arch_scene(arch) : peer_scene(a.scene);
  const KernelScene k = kernel_scene(scene);
  validate_start(k.model, k.state);

  // 2. Until the end, or half a second after something fell.
  RunPlan plan{.driver = "peer_scene",
               .name = scene.name,
               .h = a.h,
               .t_end = a.time > 0 ? a.time : scene.t_end,
               .scene = scene_text(*a.cli),
               .header = run_header(k.model),
               .gauges = gauges_of(scene),
               .options = scheme_options(*a.cli, a.run.scheme, kernel_options(scene, a.h)),
               .go_on = [](const Recording& r) { return r.state().t < r.total("fall_time") + kAfterFall; }};
  plan.header.title = "peer_scene " + scene.name;
  plan.header.command_line = a.command_line;
  const DrivenRun run = drive(k.model, k.state, std::move(plan), a.run);
  if (run.interrupted) return ExitCode::interrupted;

  // 3. What became of it.
  const std::filesystem::path& out = a.run.common.out;
  if (!draw(out, scene, run.state))
    std::fprintf(stderr, "no picture: gnuplot is missing or failed on %s\n", (out / "peer_scene.gp").c_str());
  const PeerTotals totals = totals_of(scene, k.state, run.recording);
  write_summary(a.run.common.summary, scene, totals, run);
  return tell_end(scene, k.model, totals, run) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  start_from_theta(a.run.scheme.options, 1);
  Cli cli("peer_scene",
          "Runs a scene used to compare rigid-body engines, records it, reports its error and draws it.");
  cli.group("scene");
  cli.choice("--scene", a.scene,
             "scene to run; bouncing scenes default to theta 0.5 and the normal law moreau",
             peer_scene_names());
  cli.option(setting_of<Arch>("stones"), a.arch.stones);
  cli.option(setting_of<Arch>("mu"), a.arch.mu);
  cli.option(setting_of<Arch>("thickness"), a.arch.thickness);
  cli.option(in_degrees(setting_of<Arch>("tilt")), a.tilt);
  cli.option(setting_of<Arch>("scatter"), a.arch.scatter);
  cli.group("stepping");
  cli.option("--h", a.h, "largest step", "s", setting_of<StepOptions>("h").range);
  cli.option("--time", a.time, "time to simulate; 0: the whole scene", "s", kTime);
  a.cli = &cli;
  add_run_options(cli, a.run);
  cli.example("peer_scene --mu 0.25", "an arch that slides apart");
  cli.example("peer_scene --thickness 0.1", "an arch that is too thin and folds over four hinges");
  return run_driver(cli, argc, argv, [&] {
    check(cli, a.run);
    if (a.scene != "arch")
      refuse_given(cli, {"--stones", "--mu", "--thickness", "--tilt", "--scatter"}, "--scene arch");
    return run(a);
  });
}
