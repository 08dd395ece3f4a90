// SPDX-License-Identifier: Apache-2.0
// Times pairs, contacts and a whole step per body, at the same packing from 1e3 to 1e5 bodies. Read the
// ratios to the smallest size: 1 is linear.
//
// Theory   doc/theory/conservative_advancement.md (CA-11), (CA-12); doc/decisions/0009
// Run      bench_many_bodies
//          bench_many_bodies --scene spheres --largest 100000 --largest-step 1000 --json many.json
// Expect   ratio_query within 1.5 at every size
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <random>

#include "examples/common/driver.hpp"
#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"
#include "integrators/pose/step_pairs.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/csv_table.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

constexpr double kSize = 0.01;     // of a body [m]
constexpr double kDensity = 1000;  // [kg/m^3]
constexpr int kLayers = 10;        // the height of every scene in bodies
constexpr double kStep = 1e-3;     // [s]
constexpr double kSpeed = 0.3;     // all fall, the lowest layer hits the ground within the step [m/s]

struct Arguments {
  std::string scene = "both";
  int largest = 100000, largest_step = 10000, repeats = 3, max_sweeps = 200;
  CommonOptions common{};
};

class Random {
 public:
  double operator()(double half) { return half * (2 * double(engine_() >> 11) * 0x1p-53 - 1); }
  std::size_t index(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_{4};
};

struct Scene {
  Model model{};
  State state{};
};

void add_box(Model& model, int columns, double pitch,
             double floor) {  // open at the top; sheets of two triangles
  const double wide = columns * pitch + 4e-4, high = kLayers * pitch + kSize;
  const auto ground = add(model, prepare(dilate(make_plate(wide, wide), 1e-4)));
  const auto wall = add(model, prepare(dilate(make_plate(high, wide), 1e-4)));
  RigidBody body = fixed_body("ground", ground);
  body.g_bs = translation(columns * pitch / 2, columns * pitch / 2, floor);
  add(model, body);
  for (int side = 0; side < 4; ++side) {
    const SE3 around =
        translation(columns * pitch / 2, columns * pitch / 2, 0) * rotation(Vec3::UnitZ(), side * kPi / 2);
    body = fixed_body("wall", wall);
    body.g_bs = around * translation(wide / 2, 0, floor + high / 2) * rotation(Vec3::UnitY(), kPi / 2);
    add(model, body);
  }
}

// Bodies on a lattice that is ten high, each a little off its place.
Scene lattice(int n, const std::vector<DilatedShape>& shapes, const std::vector<MassProperties>& mass,
              double pitch, double shift, double tilt) {
  Scene s;
  const int columns = int(std::ceil(std::sqrt(double(n) / kLayers)));
  std::vector<ShapeId> index;
  for (const DilatedShape& shape : shapes) index.push_back(add(s.model, prepare(shape)));
  add_box(s.model, columns, pitch, -2e-4);
  const int first = int(s.model.bodies.size());
  Random jitter;
  for (int i = 0; i < n; ++i) {
    const std::size_t kind = jitter.index(shapes.size());
    add(s.model, solid_body("body", index[kind], mass[kind]));
  }
  s.state = rest_state(s.model);
  for (int i = 0; i < n; ++i) {
    const auto body = BodyId::at(first + i);
    const int layer = i / (columns * columns), row = i / columns % columns, column = i % columns;
    twist(s.state, body)[2] = -kSpeed;
    SE3& g = pose(s.state, body);
    g.p = pitch * Vec3(column + 0.5, row + 0.5, layer + 0.5);
    for (double& x : g.p) x += jitter(shift);
    const double yaw = jitter(tilt), a = jitter(tilt), b = jitter(tilt);
    g.R = (exp_so3(Vec3(a, b, 0)) * exp_so3(Vec3(0, 0, yaw))).normalized();
  }
  return s;
}

Scene spheres(int n) {  // dilated points: as close as 0.2 % of their size
  const double radius = kSize / 2, mass = kDensity * 4 / 3 * kPi * std::pow(radius, 3);
  return lattice(
      n, {dilate(make_point(), radius)},
      {{.mass = mass, .centre = Vec3::Zero(), .inertia = 0.4 * mass * radius * radius * Mat3::Identity()}},
      1.012 * kSize, 0.005 * kSize, 0);
}

Scene mixed_parts(
    int n) {  // 12 to 188 triangles; they stand on each other within the small rotations forgiven
  const double radius = 2.5e-4, side = kSize - 2 * radius;
  std::vector<DilatedShape> shapes;
  std::vector<MassProperties> mass;
  for (const SimplicialComplex& part : {make_box(side, side, side), make_cylinder(side / 2, side, 16),
                                        make_box(0.8 * side, 0.9 * side, side, 2),
                                        make_cylinder(0.45 * side, side, 48), make_sphere(side / 2, 1)}) {
    shapes.push_back(dilate(part, radius));
    mass.push_back(mass_properties(part, kDensity));
  }
  return lattice(n, shapes, mass, 1.004 * kSize, 2e-4 * kSize, 1e-3);
}

double cpu_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

double fastest(int repeats, const std::function<void()>& work) {  // [s]
  double best = kInf;
  for (int i = 0; i < repeats; ++i) {
    const double begin = cpu_seconds();
    work();
    best = std::min(best, cpu_seconds() - begin);
  }
  return best;
}

struct Row {
  double bodies = 0, triangles = 0, pairs = 0, contacts = 0;
  double us_pairs = 0, us_contacts = 0,
         ratio_query = 0;  // per body; broad phase; with contacts, to the first row
  double us_step = std::nan(""), us_solve = std::nan(""), us_certificate = std::nan(""),
         ratio_step = std::nan(""), sweeps = std::nan("");
};
const std::vector<std::string> kColumns{"bodies",   "triangles",      "pairs",       "contacts",
                                        "us_pairs", "us_contacts",    "ratio_query", "us_step",
                                        "us_solve", "us_certificate", "ratio_step",  "sweeps"};
std::vector<double> values(const Row& r) {
  return {r.bodies,      r.triangles, r.pairs,    r.contacts,       r.us_pairs,   r.us_contacts,
          r.ratio_query, r.us_step,   r.us_solve, r.us_certificate, r.ratio_step, r.sweeps};
}

Row measure(const Scene& scene, int n, const Arguments& a) {
  const AdvancementOptions advancement;
  Row row{.bodies = double(n)};
  for (const RigidBody& body : scene.model.bodies)
    row.triangles += double(scene.model.shapes[body.shape]->complex.triangles.size());
  const PerBody<BodyBounds> bounds = body_bounds(scene.model);
  VecX v = VecX::Zero(scene.state.v.size());
  for (const BodyId b : scene.model.bodies.ids())
    if (is_dynamic(scene.model.bodies[b])) linear_part(v, b).z() = -kSpeed - 9.81 * kStep;
  const StepMotion estimate{scene.model, scene.state, v, kStep};
  std::vector<StepPair> pairs;
  ContactSet found;
  row.us_pairs = 1e6 / n * fastest(a.repeats, [&] {
                   pairs = step_pairs(estimate, bounds, advancement, a.common.threads).pairs;
                 });
  row.us_contacts = 1e6 / n * fastest(a.repeats, [&] {
                      found = contacts_of(scene.model, scene.state, pairs, {.threads = a.common.threads});
                    });
  row.pairs = double(pairs.size());
  row.contacts = double(found.points.size());
  if (n > a.largest_step) return row;
  const MoreauJean scheme(
      scene.model,
      {.h = kStep,
       .solver = {.method = Method::nsgs, .tolerance = 1e-4, .max_iterations = a.max_sweeps},
       .threads = a.common.threads},
      {.theta = 1});
  StepReport report;
  for (int i = 0; i < a.repeats; ++i) {
    State state = scene.state;
    const StepReport again = scheme.step(state);
    if (i == 0 || again.total.wall < report.total.wall) report = again;
  }
  row.us_step = 1e6 / n * report.total.wall;  // of the step that was accepted, its attempts included
  row.us_solve = 1e6 / n * report.stages[Stage::solve].wall;
  row.us_certificate = 1e6 / n * report.stages[Stage::certificate].wall;
  row.sweeps = report.solve.iterations;
  if (!report.moved()) std::fprintf(stderr, "%d bodies: %s\n", n, report.reason.c_str());
  return row;
}

ExitCode bench(const Arguments& a) {
  make_folders(a.common);
  Summary summary;
  bool linear = true;
  for (const std::string name : {"spheres", "mixed_parts"}) {
    if (a.scene != "both" && a.scene != name) continue;
    CsvTable csv(a.common.out / ("bench_many_bodies_" + name + ".csv"), kColumns);
    std::vector<std::vector<double>> columns(kColumns.size());
    std::printf("%s, microseconds per body on %d thread(s)\n", name.c_str(), a.common.threads);
    std::printf("%8s %9s %9s %8s %9s %6s %9s %9s %9s %6s %7s\n", "bodies", "pairs", "contacts", "pairs us",
                "cont. us", "ratio", "step us", "solve us", "cert. us", "ratio", "sweeps");
    Row first;
    for (int n = 1000; n <= a.largest && !interrupted(); n *= 10) {
      Row row = measure(name == std::string("spheres") ? spheres(n) : mixed_parts(n), n, a);
      if (n == 1000) first = row;
      row.ratio_query = (row.us_pairs + row.us_contacts) / (first.us_pairs + first.us_contacts);
      row.ratio_step = row.us_step / first.us_step;
      linear = linear && row.ratio_query <= 1.5;
      std::printf("%8.0f %9.0f %9.0f %8.3f %9.3f %6.2f %9.2f %9.2f %9.2f %6.2f %7.0f\n", row.bodies,
                  row.pairs, row.contacts, row.us_pairs, row.us_contacts, row.ratio_query, row.us_step,
                  row.us_solve, row.us_certificate, row.ratio_step, row.sweeps);
      std::fflush(stdout);
      csv.add(values(row));
      for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(values(row)[i]);
    }
    csv.close();
    for (std::size_t i = 0; i < columns.size(); ++i) summary.set(name + "_" + kColumns[i], columns[i]);
  }
  summary.set("linear", linear);
  if (!a.common.summary.empty()) write_summary(a.common.summary, summary);
  return linear ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_many_bodies", "Times pairs, contacts and a step per body, from 1e3 to 1e5 bodies in a box.");
  cli.group("scene");
  cli.choice("--scene", a.scene, "kind of the bodies", {"spheres", "mixed_parts", "both"});
  cli.option("--largest", a.largest, "number of bodies", "", {1000, 1e6});
  cli.option("--largest-step", a.largest_step, "number of bodies up to which steps are timed", "", {0, 1e6});
  cli.option("--sweeps", a.max_sweeps, "maximum number of sweeps of the solver in a timed step", "",
             {1, 1e6});
  cli.option("--repeats", a.repeats, "number of runs of each query; the fastest counts", "", {1, 1000});
  cli.group("output");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.common(a.common);
  cli.example("bench_many_bodies --largest 10000", "both scenes");
  cli.example("bench_many_bodies --scene spheres --largest-step 0 --json many.json", "queries alone");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
