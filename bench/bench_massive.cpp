// SPDX-License-Identifier: Apache-2.0
// Times a part of ever more triangles: complex, repair, preparation, cache, and steps of two such parts that
// roll on each other. Read times per triangle and the ratio of the steps: both should not grow.
//
// Theory   doc/theory/lmd.md (LMD-9), (LMD-13); doc/decisions/0026
// Run      bench_massive
//          bench_massive --largest 10000000 --threads 2 --json massive.json
// Expect   less than 1000 bytes per triangle while a part is prepared; two parts of 1e6 triangles loaded
//          within a second; a step of two such parts within 1.5 of one of 1e5
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <malloc.h>

#include "bench/verdict.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/quantile.hpp"
#include "geometry/mass_properties.hpp"
#include "geometry/mesh_repair.hpp"
#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/csv_table.hpp"
#include "io/shape_cache.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

constexpr double kMajor = 0.3, kMinor = 0.05;  // of a wheel [m]
constexpr double kDilation = 1e-4;             // [m]
constexpr double kDensity = 7850;              // [kg/m^3]
constexpr double kSpeed = 1e-3;                // at which one wheel moves along the other [m/s]
constexpr double kStep = 1e-3;                 // [s]

struct Arguments {
  double largest = 1e6;
  int steps = 50;
  bool no_repair = false;
  CommonOptions common{};
};

template <class F>
double timed(F&& f) {  // wall time [s]
  const StageTime begin = time_now(false);
  f();
  return time_since(begin, false).wall;
}

// "VmHWM" and "VmRSS" [bytes]; 0 where the system does not tell.
double memory(const char* name) {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;)
    if (double kib = 0; word == std::string(name) + ":" && file >> kib) return 1024 * kib;
  return 0;
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

SimplicialComplex wheel(double triangles) {  // only the two triangles of a facet lie in one plane
  const int around = int(std::ceil(std::sqrt(triangles / 8)));
  return make_torus(kMajor, kMinor, 4 * around, around);
}

struct Row {
  double triangles = 0, us_complex = 0, us_repair = 0, us_prepare = 0, peak_bytes = 0, search_bytes = 0,
         us_keep = 0, file_bytes = 0, us_load = 0, loaded_bytes = 0, ms_step = 0, contacts = 0;
};
const std::vector<std::string> kColumns{"triangles",  "us_complex",   "us_repair", "us_prepare",
                                        "peak_bytes", "search_bytes", "us_keep",   "file_bytes",
                                        "us_load",    "loaded_bytes", "ms_step",   "contacts"};
std::vector<double> values(const Row& r) {
  return {r.triangles, r.us_complex, r.us_repair, r.us_prepare,   r.peak_bytes, r.search_bytes,
          r.us_keep,   r.file_bytes, r.us_load,   r.loaded_bytes, r.ms_step,    r.contacts};
}

// One wheel falls on the other, side by side, and rolls along its rim: the median of its steps.
void step(const LmdShape& shape, const Arguments& a, Row& row) {
  Model model;
  model.gravity = Vec3(-9.81, 0, 0);
  const ShapeId wheel = add(model, shape);
  add(model, fixed_body("fixed", wheel));
  const BodyId rolling = add(model, solid_body("rolling", wheel, mass_properties(shape.complex, kDensity)));
  State state = rest_state(model);
  pose(state, rolling).p.x() = 2 * (kMajor + kMinor + kDilation);
  linear_part(state.v, rolling).y() = kSpeed;
  const MoreauJean scheme(model, {.h = kStep, .threads = a.common.threads}, {.theta = 1});
  std::vector<double> wall;
  for (int i = 0; i < a.steps && !interrupted(); ++i) {
    const StepReport report = scheme.step(state);
    if (!report.moved()) throw std::runtime_error("step " + std::to_string(i) + ": " + report.reason);
    wall.push_back(report.total.wall);
    row.contacts = std::max(row.contacts, double(report.contacts.size()));
  }
  row.ms_step = 1e3 * quantile(wall, 0.5);
}

Row measure(double wanted, const Arguments& a) {
  Row row;
  SimplicialComplex complex;
  const double make = timed([&] { complex = wheel(wanted); });
  row.triangles = double(complex.triangles.size());
  const double us = 1e6 / row.triangles;
  row.us_complex = us * make;
  if (!a.no_repair) row.us_repair = us * timed([&] { repair_mesh(complex); });

  const std::filesystem::path folder = a.common.out / "shapes";
  std::filesystem::remove_all(folder);
  const LmdShapeOptions options{.threads = a.common.threads};
  {
    LmdShape prepared;
    forget_peak();
    const double before = memory("VmRSS");
    row.us_prepare = us * timed([&] { prepared = prepare(dilate(complex, kDilation), options); });
    row.peak_bytes = (memory("VmHWM") - before) / row.triangles;
    row.search_bytes = double(search_bytes(prepared)) / row.triangles;
    std::filesystem::create_directories(folder);
    row.us_keep = us * timed([&] { write_lmd_shape(folder / "wheel.h5", prepared, 1); });
    row.file_bytes = double(std::filesystem::file_size(folder / "wheel.h5")) / row.triangles;
  }
  complex = {};
  forget_peak();
  const double before = memory("VmRSS");
  LmdShape shape;
  row.us_load = us * timed([&] { shape = read_lmd_shape(folder / "wheel.h5", 1); });
  step(shape, a, row);
  row.loaded_bytes = (memory("VmRSS") - before) / row.triangles;
  std::filesystem::remove_all(folder);
  return row;
}

ExitCode bench(const Arguments& a) {
  make_folders(a.common);
  CsvTable csv(a.common.out / "bench_massive.csv", kColumns);
  std::printf("per triangle, on %d thread(s)\n", a.common.threads);
  std::printf("%10s %8s %8s %8s %7s %7s %8s %7s %8s %7s %9s %8s\n", "triangles", "make us", "repair",
              "prepare", "peak B", "search", "keep us", "file B", "load us", "after", "step ms", "contacts");
  std::vector<Row> rows;
  for (double n = 1e5; n <= a.largest * 1.001 && !interrupted(); n *= 10) {
    const Row& row = rows.emplace_back(measure(n, a));
    std::printf("%10.0f %8.2f %8.2f %8.2f %7.0f %7.0f %8.2f %7.0f %8.3f %7.0f %9.3f %8.0f\n", row.triangles,
                row.us_complex, row.us_repair, row.us_prepare, row.peak_bytes, row.search_bytes, row.us_keep,
                row.file_bytes, row.us_load, row.loaded_bytes, row.ms_step, row.contacts);
    std::fflush(stdout);
    csv.add(values(row));
  }
  csv.close();
  if (interrupted()) return ExitCode::interrupted;

  std::vector<Bar> bars;
  for (const Row& row : rows) {
    const std::string where = formatted("%.3g triangles", row.triangles);
    bars.push_back({"peak_bytes", "bytes per triangle while preparing", where, row.peak_bytes, 1000});
    bars.push_back(
        {"loaded_bytes", "bytes per triangle after a load and steps", where, row.loaded_bytes, 200});
    if (&row == &rows.front()) continue;
    const double growth = std::log(row.triangles / rows.front().triangles);
    bars.push_back({"exponent", "exponent of the time to prepare", where,
                    1 + std::log(row.us_prepare / rows.front().us_prepare) / growth, 1.1});
    bars.push_back({"step_ratio", "time of a step over that of the smallest", where,
                    row.ms_step / rows.front().ms_step, 1.5});
    if (row.triangles < 2e6)
      bars.push_back({"load_two", "seconds to load two", where, 2e-6 * row.us_load * row.triangles, 1});
  }
  Summary summary;
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    std::vector<double> column;
    for (const Row& row : rows) column.push_back(values(row)[c]);
    summary.set(kColumns[c], column);
  }
  return conclude(bars, std::move(summary), a.common);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_massive", "Times preparation, cache and steps of wheels of 1e5 triangles and more.");
  cli.group("scene");
  cli.option("--largest", a.largest, "triangles of the largest wheel", "", {1e5, 1e7});
  cli.option("--steps", a.steps, "steps of two wheels; the median counts", "", {1, 1e5});
  cli.flag("--no-repair", a.no_repair, "leave the repair out");
  cli.group("output");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.common(a.common);
  cli.example("bench_massive --largest 10000000 --threads 2", "up to ten million triangles");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
