// SPDX-License-Identifier: Apache-2.0
// Times fast parts on fine meshes, with and without levels of detail: a ring that hits the rim of a wheel, a
// ball that is shot at a dented door, a nut that is spun on its bolt. Read how contacts and time grow with
// the speed, and the ratio of both ways in one run.
//
// Theory   doc/theory/levels.md (LOD-4) to (LOD-7)
// Run      bench_levels
//          bench_levels --triangles 1e6 --levels-alone --json levels.json
// Expect   contacts grow at most 3 times, the most expensive step at most 4 times, while the speed grows 1000
//          times; every step is certified
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/verdict.hpp"
#include "examples/common/driver.hpp"
#include "geometry/fastener.hpp"
#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/csv_table.hpp"
#include "io/summary.hpp"
#include "lmd/certificate.hpp"
#include "lmd/shape_levels.hpp"

using namespace aussois;

namespace {

constexpr double kDilation = 1e-4;  // [m]
constexpr double kDensity = 7850;   // [kg/m^3]
constexpr double kStep = 1e-3;      // [s]
constexpr double kBefore = 3.5;     // steps to the impact
constexpr int kSteps = 10;          // of a run, in lengths of a full step

struct Arguments {
  double triangles = 1e5;
  int levels = 5;
  bool levels_alone = false;
  CommonOptions common{};
};

// A part that flies at another, or screws on it where it has a lead.
struct Scene {
  const char* name = "";
  std::vector<double> speeds{};  // [m/s]; of a screw [rad/s]
  SimplicialComplex target{}, part{};
  Vec3 from = Vec3::Zero(), direction = Vec3::Zero();
  double lead = 0;  // [m/rad]
};

SimplicialComplex dented_door(double triangles) {
  const int n = int(std::ceil(std::sqrt(triangles / 2)));
  const SimplicialComplex flat = make_plate(1, 1, n, n);
  std::vector<Vec3> vertices = flat.vertices.to_vector();
  for (Vec3& x : vertices) x.z() = 0.05 * x.x() * x.x() + 2e-3 * std::sin(40 * x.x()) * std::sin(30 * x.y());
  return make_complex(std::move(vertices), flat.triangles);
}

std::vector<Scene> scenes(double triangles) {
  const int around = int(std::ceil(std::sqrt(triangles / 8)));
  const int facets = 8 * int(std::clamp(triangles / 8 / 400, 6.0, 30.0));
  const FastenerOptions fine{.clearance = 5e-4, .facets = facets};
  return {{.name = "ring",
           .speeds = {0.1, 1, 10, 100},
           .target = make_torus(0.3, 0.05, 4 * around, around),
           .part = make_torus(0.02, 0.01, 120, 60),
           .from = Vec3(0.32, 0.02, 0.2),
           .direction = Vec3(0.05, 0.1, -1).normalized()},
          {.name = "door",
           .speeds = {1, 10, 100, 1000},
           .target = dented_door(triangles),
           .part = make_sphere(5e-3, 4),
           .from = Vec3(0, 0, 0.2),
           .direction = Vec3(0.3, 0.1, -1).normalized()},
          {.name = "nut",  // 3, 30, 300 and 3000 rpm
           .speeds = {0.314, 3.14, 31.4, 314},
           .target = make_bolt(fine),
           .part = make_nut(fine),
           .from = Vec3(0, 0, fine.pitch),
           .lead = fine.pitch / (2 * kPi)}};
}

// Where the part meets the target on its way: moved on by the distance of the two until that is nothing.
Vec3 meeting_place(const Scene& scene, const LmdShape& target, const LmdShape& part) {
  Vec3 x = scene.from;
  for (double distance = 1; distance > 1e-6 && scene.lead == 0;) {
    distance = base_distance({&part, {}, {.g = translation(x.x(), x.y(), x.z())}}, {&target, {}, {}}, 1) -
               target.radius - part.radius;
    x += distance * scene.direction;
  }
  return x;
}

State start_of(const Model& model, const Scene& scene, const Vec3& meeting, BodyId part, double speed) {
  State state = rest_state(model);
  pose(state, part).p = meeting - kBefore * kStep * speed * scene.direction - model.bodies[part].g_bs.p;
  linear_part(state.v, part) =
      scene.lead > 0 ? Vec3(0, 0, scene.lead * speed) : Vec3(speed * scene.direction);
  if (scene.lead > 0) angular_part(state.v, part).z() = speed;
  return state;
}

struct Row {
  const char* scene = "";
  double speed = 0;
  int levels = 0, steps = 0, attempts = 0, contacts = 0, kept = 0;
  double ms_mean = 0, ms_max = 0;
};
const std::vector<std::string> kColumns{"scene",    "speed", "levels",  "steps", "attempts",
                                        "contacts", "kept",  "ms_mean", "ms_max"};

Row run_scene(const Scene& scene, const LmdShape& target, const LmdShape& part, const Vec3& meeting,
              double speed, int levels, const Arguments& a) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, fixed_body("target", add(model, target)));
  const BodyId flying =
      add(model, solid_body(scene.name, add(model, part), mass_properties(scene.part, kDensity)));
  State state = start_of(model, scene, meeting, flying, speed);
  const StepOptions options{.h = kStep, .levels = levels, .threads = a.common.threads, .profile = true};
  const MoreauJean scheme(model, options, {.theta = 1});
  Row row{.scene = scene.name, .speed = speed, .levels = levels};
  double sum = 0;
  const StepReport last = run(scheme, state, kSteps * kStep, [&](const StepReport& report) {
    if (!report.moved()) return false;
    ++row.steps;
    row.attempts += report.attempts;
    row.contacts = std::max(row.contacts, report.contacts_found);
    row.kept = std::max(row.kept, report.contacts_kept);
    row.ms_max = std::max(row.ms_max, 1e3 * report.total.cpu);
    sum += 1e3 * report.total.cpu;
    return !interrupted();
  });
  if (!last.moved()) throw std::runtime_error(std::string(scene.name) + ": " + last.reason);
  row.ms_mean = sum / std::max(1, row.steps);
  return row;
}

void print(const Row& r) {
  std::printf("%6s %9.4g %6d %6d %8d %9d %6d %10.3f %10.3f\n", r.scene, r.speed, r.levels, r.steps,
              r.attempts, r.contacts, r.kept, r.ms_mean, r.ms_max);
  std::fflush(stdout);
}

void add_bars(const std::vector<Row>& rows, std::vector<Bar>& bars) {  // of one scene, with levels
  const auto [slow, fast] = std::ranges::minmax(rows, {}, &Row::speed);
  const std::string where = formatted("%s, %g times as fast", slow.scene, fast.speed / slow.speed);
  const auto most = [&](int Row::*of) { return std::ranges::max(rows, {}, of).*of; };
  bars.push_back({"contacts", "contacts found over those of the slowest", where,
                  double(most(&Row::contacts)) / std::max(1, slow.contacts), 3});
  bars.push_back({"step", "most expensive step over that of the slowest", where,
                  std::ranges::max(rows, {}, &Row::ms_max).ms_max / slow.ms_max, 4});
}

ExitCode bench(const Arguments& a) {
  make_folders(a.common);
  CsvTable csv(a.common.out / "bench_levels.csv", kColumns);
  std::vector<Bar> bars;
  Summary summary;
  const std::vector<Scene> all = scenes(a.triangles);
  for (const Scene& scene : all) {
    const LmdShapeOptions prepared{.levels = a.levels, .threads = a.common.threads};
    const StageTime begin = time_now(false);
    const LmdShape target = prepare(dilate(scene.target, kDilation), prepared),
                   part = prepare(dilate(scene.part, kDilation), prepared);
    std::printf("\n%s: %zu and %zu triangles, prepared in %.1f s; levels of", scene.name,
                target.complex.triangles.size(), part.complex.triangles.size(),
                time_since(begin, false).wall);
    for (int k = 1; k <= level_count(target); ++k)
      std::printf(" %zu (%.3g mm off)", level_shape(target, k).complex.triangles.size(),
                  1e3 * level_off(target, k));
    std::printf("\n%6s %9s %6s %6s %8s %9s %6s %10s %10s\n", "scene", "m/s rad/s", "levels", "steps",
                "attempts", "contacts", "kept", "ms mean", "ms max");
    const Vec3 meeting = meeting_place(scene, target, part);
    std::vector<Row> with;
    for (const double speed : scene.speeds)
      for (const int levels : {a.levels, 0}) {
        if (interrupted()) return ExitCode::interrupted;
        if (levels == 0 && a.levels_alone) continue;
        const Row row = run_scene(scene, target, part, meeting, speed, levels, a);
        print(row);
        csv.add({double(&scene - all.data()), row.speed, double(row.levels), double(row.steps),
                 double(row.attempts), double(row.contacts), double(row.kept), row.ms_mean, row.ms_max});
        const std::string key = formatted("%s_%g_%s", row.scene, row.speed, levels > 0 ? "levels" : "shapes");
        summary.set(key + "_ms_max", row.ms_max);
        summary.set(key + "_ms_mean", row.ms_mean);
        summary.set(key + "_contacts", std::int64_t(row.contacts));
        if (levels > 0) with.push_back(row);
      }
    add_bars(with, bars);
  }
  csv.close();
  std::printf("\n");
  return conclude(bars, std::move(summary), a.common);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_levels", "Times fast parts on fine meshes with and without levels of detail.");
  cli.group("scene");
  cli.option("--triangles", a.triangles, "triangles of the larger part of each scene, roughly", "",
             {1e3, 1e7});
  cli.option("--detail-levels", a.levels, "coarser surfaces of each part", "", {1, kMostLevels});
  cli.flag("--levels-alone", a.levels_alone, "leave out the runs without levels");
  cli.group("output");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.common(a.common);
  cli.example("bench_levels --triangles 1e6 --levels-alone",
              "parts of a million triangles, with levels alone");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
