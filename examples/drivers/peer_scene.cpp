// SPDX-License-Identifier: Apache-2.0
// Runs a scene used to compare rigid-body engines with Moreau-Jean or another scheme, measures its error
// against exact results, and draws the bodies at the start and at the end.
//
// Theory   doc/theory/peer_scenes.md
// Run      peer_scene --time 2
//          peer_scene --mu 0.25 --time 1
//          peer_scene --scene tower --time 2
// Expect   the arch stands if its friction is above 0.3077, and falls if it is below
#include <algorithm>
#include <cstdio>

#include "examples/common/gnuplot.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/scenes/peer_scenes.hpp"
#include "integrators/run.hpp"
#include "io/atomic_file.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string scene = "arch";
  Arch arch{};
  double tilt = 0, h = 1e-2, time = 0;  // [deg, s, s]
  SchemeFlags scheme{};
  const Cli* cli = nullptr;
  CommonOptions common{};
};

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

ExitCode run(const Arguments& a) {
  // 1. The scene.
  Arch arch = a.arch;
  arch.tilt = a.tilt * kPi / 180;
  const PeerScene scene = a.scene == "arch" ? arch_scene(arch) : peer_scene(a.scene);
  KernelScene k = kernel_scene(scene);
  SchemeOptions options = scheme_options(*a.cli, a.scheme, kernel_options(scene, a.h));
  options.step.threads = a.common.threads;
  const Scheme scheme = make_scheme(a.scheme.scheme, k.model, options);
  const double t_end = a.time > 0 ? a.time : scene.t_end;

  // 2. Until the end, or half a second after something fell.
  PeerJudge judge(scene);
  judge.see(sample(k.state));
  make_folders(a.common);
  Progress progress("peer_scene", t_end, Progress::style_of_stderr(a.common.quiet));
  const StepReport last = aussois::run(scheme, k.state, t_end, [&](const StepReport& report) {
    if (!report.ok()) return false;
    judge.see(sample(k.state));
    progress.at(k.state.t);
    return k.state.t < judge.fall_time() + 0.5 && !interrupted();
  });
  if (!last.ok()) throw NumericalFailure("t = " + std::to_string(k.state.t) + " s: " + last.reason);
  if (interrupted()) return ExitCode::interrupted;

  // 3. What became of it.
  std::printf("peer_scene: %s, %s; error %.3g after %.3g s\n", scene.name.c_str(),
              judge.fall_time() < kInf
                  ? ("a body was 0.1 m off its place at " + std::to_string(judge.fall_time()) + " s").c_str()
                  : "stands",
              judge.error(), k.state.t);
  if (!draw(a.common.out, scene, k.state))
    std::fprintf(stderr, "no picture: gnuplot is missing or failed on %s\n",
                 (a.common.out / "peer_scene.gp").c_str());
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("error", judge.error());
    summary.set("fall_time", judge.fall_time() < kInf ? judge.fall_time() : -1);
    write_summary(a.common.summary, summary);
  }
  return ExitCode::ok;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("peer_scene",
          "Runs a scene used to compare rigid-body engines, reports its error and draws it. run_scene "
          "records the same scenes and audits the certificate of every step (--certify).");
  cli.group("scene");
  cli.choice("--scene", a.scene, "scene to run", peer_scene_names());
  cli.option("--stones", a.arch.stones, "number of stones of the arch", "", {3, 1001});
  cli.option("--mu", a.arch.mu, "friction coefficient of the arch's stones and its ground", "-", {0, 10});
  cli.option("--thickness", a.arch.thickness, "thickness of the arch, relative to its mean radius", "-",
             {0.01, 0.9});
  cli.option("--tilt", a.tilt, "tilt of arch and ground", "deg", {-60, 60});
  cli.option("--scatter", a.arch.scatter, "largest random offset of each stone of the arch; 0: exact places",
             "m", {0, 1e-3});
  cli.group("stepping");
  cli.option("--h", a.h, "largest step", "s", {1e-5, 0.1});
  cli.option("--time", a.time, "time to simulate; 0: the whole scene", "s", {0, 1e5});
  a.cli = &cli;
  add_options(cli, a.scheme);
  cli.common(a.common);
  cli.example("peer_scene --mu 0.25", "an arch that slides apart");
  cli.example("peer_scene --thickness 0.1", "an arch that is too thin and folds over four hinges");
  return run_driver(cli, argc, argv, [&] {
    refuse_unread(cli, a.scheme);
    return run(a);
  });
}
