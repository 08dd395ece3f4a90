// SPDX-License-Identifier: Apache-2.0
// Contacts of solids: rows F1.contact_patch, F4, F5 and F10 of group F.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "examples/scenes/solids.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

// A sheet across z that stays where it is.
BodyId add_floor(Model& model, double size, double z) {
  return add(model, RigidBody{.name = "floor",
                              .shape = add(model, prepare(dilate(make_plate(size, size), 0))),
                              .g_bs = translation(0, 0, z),
                              .motion = FixedMotion{}});
}

// z becomes the axis `up`.
Vec3 turned(const Vec3& x, int up) {
  Vec3 out;
  for (int d = 0; d < 3; ++d) out[(d + up + 1) % 3] = x[d];
  return out;
}

// Contacts on the common rim turn by what a vertex stands beyond it, over the sum of the radii. With 1 mm not
// all settlings end: one goes round within 2e-9 m.
constexpr double kBlockRadius = 1e-2;  // [m]

// A block of cells x cells x 2 above z = `above`, its points on the side that touches moved about; held on
// two sides, and at the bottom if it lies below.
Solid add_block(Model& model, int cells, bool below, double above, int up, std::mt19937& random) {
  std::uniform_real_distribution<double> part(-0.2, 0.2);
  VolumeMesh mesh = make_box_mesh({1, 1, 0.5}, {cells, cells, 2});
  for (Vec3& x : mesh.points)
    if (std::abs(x.z() - (below ? 0.25 : -0.25)) < 1e-9)
      for (int d = 0; d < 2; ++d)
        if (std::abs(x[d]) < 0.49) x[d] += part(random) / cells;
  SolidOptions options{.materials = {{.young = 1, .poisson = 0.3, .density = 1}}, .radius = kBlockRadius};
  const auto hold_side = [&](int d, double at) {
    std::array<bool, 3> axes{};
    axes[std::size_t(d + up + 1) % 3] = true;
    hold(mesh, options, axes, [=](const Vec3& x) { return x[d] < at; });
  };
  hold_side(0, -0.499);
  hold_side(1, -0.499);
  if (below) hold_side(2, -0.249);
  for (Vec3& x : mesh.points) x = turned(x + Vec3(0, 0, above), up);
  return add_solid(model, mesh, options);
}

// Two blocks whose meshes do not match, or one on a rigid floor, pressed together across axis `up`. Their
// stress is even.
double stress_off(int up, double mu, bool on_floor) {
  constexpr double kPressure = 0.01;
  std::mt19937 random(2);
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = 0;  // at first
  std::vector<Solid> blocks;
  if (on_floor) {
    const SimplicialComplex plate = make_plate(4, 4);
    std::vector<Vec3> corners;
    for (const Vec3& x : plate.vertices) corners.push_back(turned(x - Vec3(0, 0, 0.25 + kBlockRadius), up));
    add(model, fixed_body("floor", add(model, prepare(dilate(make_complex(corners, plate.triangles), 0)))));
  } else {
    blocks.push_back(add_block(model, 3, true, -(0.5 + 2 * kBlockRadius), up, random));
  }
  blocks.push_back(add_block(model, 4, false, 0, up, random));
  const std::vector<Vec3>& top = blocks.back().mesh->points;
  double highest = -kInf;
  for (const Vec3& x : top) highest = std::max(highest, x[up]);
  std::vector<std::array<int, 3>> faces = boundary_triangles(*blocks.back().mesh);
  std::erase_if(faces, [&](const std::array<int, 3>& t) {
    return std::ranges::any_of(t, [&](int p) { return top[std::size_t(p)][up] < highest - 1e-9; });
  });
  add_pressure(model, blocks.back(), faces, [](double) { return kPressure; });
  State state = rest_state(model);
  const MoreauJean scheme(model, {.h = 4, .solver = {.tolerance = 1e-14}},
                          {.theta = 1, .law = NormalLaw::gap_over_step});
  require_accepted(settle(scheme, state, {.displacement = 3e-13}));
  if (mu > 0) {
    model.contact_law.mu = mu;
    const MoreauJean rough(model, {.h = 4, .solver = {.tolerance = 1e-12}},
                           {.theta = 1, .law = NormalLaw::gap_over_step});
    for (int k = 0; k < 2; ++k) step(rough, state);
  }
  const Mat3 exact = -kPressure * Vec3::Unit(up) * Vec3::Unit(up).transpose();
  Worst off;
  for (const Solid& block : blocks)
    for (const Mat3& stress : solid_stresses(model, state, block))
      off.add((stress - exact).norm() / kPressure);
  return off;
}

VerificationCase contact_patch() {
  return {.name = "F1.contact_patch",
          .what =
              "blocks of 3 x 3 x 2 and 4 x 4 x 2 smoothed cells that do not match, pressed together across "
              "x, y and z without friction, then with mu = 0.5, and one of them on a rigid floor",
          .rows = {{"stress", "largest stress off the pressure, relative", "-", 1e-10,
                    "exact: minima of distance integrate linear functions"},
                   {"friction", "the same after two steps more with friction", "-", 1e-10,
                    "exact: both sides spread alike"},
                   {"floor", "the same on the floor, without friction", "-", 1e-10, "exact: faces are flat"}},
          .measure =
              [] {
                Worst without, with;
                for (int up = 0; up < 3; ++up) without.add(stress_off(up, 0, false));
                with.add(stress_off(2, 0.5, false));
                return Figures{{"stress", without}, {"friction", with}, {"floor", stress_off(2, 0, true)}};
              },
          .slow = true};
}

// An elastic bar thrown against a wall.
Figures throw_bar(int cells, SolidMass mass) {
  constexpr double kLength = 1, kYoung = 210e9, kDensity = 7800, kArea = 3.14e-4, kSpeed = 0.1, kGap = 5e-5,
                   kRadius = 1e-5;
  const double side = std::sqrt(kArea), wave = std::sqrt(kYoung / kDensity);
  const VolumeMesh mesh = make_box_mesh({side, side, kLength}, {1, 1, cells}, CellKind::hexes);
  const std::vector<int> foot = points_where(mesh, [](const Vec3& x) { return x.z() < -0.4999999; });
  Model model;
  model.gravity = Vec3::Zero();
  const Solid bar = add_solid(model, mesh,
                              {.materials = {{.young = kYoung, .poisson = 0, .density = kDensity}},
                               .place = translation(0, 0, kLength / 2 + kGap + kRadius),
                               .mean_volume = false,
                               .mass = mass,
                               .touching = foot,
                               .radius = kRadius});
  add_floor(model, 1, 0);
  State state = rest_state(model);
  throw_solid(model, state, bar, -kSpeed * Vec3::UnitZ());
  const double h = kGap / kSpeed / std::round(kGap / kSpeed * wave * cells / kLength),
               before = energy(model, state).total();
  const MoreauJean scheme(model, {.h = h, .solver = {.tolerance = 1e-12}},
                          {.theta = 0.5, .law = NormalLaw::gap_over_step, .gamma = 0.5});
  std::vector<double> forces;
  double last = 0;
  const double touch = kGap / kSpeed, leave = touch + 2 * kLength / wave;
  run_accepted(scheme, state, 1.2e-3, [&](const StepReport& report) {
    double sum = 0;
    for (const StepContact& c : report.contacts) sum += c.impulse.norm() / report.h;
    if (sum > 0) last = report.t;
    const double part = (report.t - touch) / (leave - touch);
    if (part > 0.25 && part < 0.75) forces.push_back(sum);  // where the grid no longer rings
    return true;
  });
  const double mean = std::accumulate(forces.begin(), forces.end(), 0.0) / double(forces.size());
  double scatter = 0;
  for (const double f : forces) scatter += (f - mean) * (f - mean);
  scatter = std::sqrt(scatter / double(forces.size()));
  const double exact = kYoung * kArea * kSpeed / wave;
  return {{"energy", std::abs(energy(model, state).total() / before - 1)},
          {"force", std::abs(mean / exact - 1)},
          {"scatter", scatter / exact},
          {"leaves", std::abs(last - leave) / (2 * kLength / wave)}};
}

VerificationCase bar_on_wall() {
  return {.name = "F4.bar",
          .what =
              "elastic bar of 100 hexahedra thrown against a wall, its foot without mass, gap over step "
              "on mean velocities, theta = 1/2, one cell a step",
          .rows = {{"energy", "energy kept, off", "-", 1e-4, "d'Alembert: all of it"},
                   {"force", "mean force in the middle half of the contact, relative", "-", 5e-3,
                    "d'Alembert: E A v / c"},
                   {"scatter", "its scatter there, over the force", "-", 5e-3, "d'Alembert: constant"},
                   {"leaves", "time of leaving, over the time of contact", "-", 2e-2,
                    "d'Alembert: 2 L / c; two steps"}},
          .measure = [] { return throw_bar(100, SolidMass::redistributed); }};
}

// An elastic bar that falls onto a floor and bounces.
VerificationCase bouncing_bar() {
  return {.name = "F5.bouncing_bar",
          .what =
              "elastic bar of 20 hexahedra that falls and bounces, three times as long in flight as on the "
              "floor, "
              "strains of 0.3 %, its foot without mass, gap over step on mean velocities, theta = 1/2, ten "
              "steps a "
              "cell",
          .rows = {{"energy", "energy after three bounces, over what it fell with, off", "-", 1e-3,
                    "d'Alembert: all of it"},
                   {"force", "mean force in the middle half of the first bounce, relative", "-", 5e-3,
                    "d'Alembert: A rho c (v + g t)"},
                   {"speed", "speed of its centre after the first bounce, relative", "-", 5e-2,
                    "d'Alembert: as fast as before, after 2 L / c; a cell of twenty"}},
          .measure =
              [] {
                constexpr double kLength = 10, kYoung = 1e5, kFall = 0.045, kRadius = 1e-2, kAccelerates = 10,
                                 kEnd = 0.8;
                constexpr int kCells = 20;
                const double wave = std::sqrt(kYoung);
                const VolumeMesh mesh = make_box_mesh({1, 1, kLength}, {1, 1, kCells}, CellKind::hexes);
                Model model;
                model.gravity = {0, 0, -kAccelerates};
                add_solid(model, mesh,
                          {.materials = {{.young = kYoung, .poisson = 0, .density = 1}},
                           .place = translation(0, 0, kLength / 2 + kFall + kRadius),
                           .mean_volume = false,
                           .mass = SolidMass::redistributed,
                           .touching = points_where(mesh, [](const Vec3& x) { return x.z() < -4.999999; }),
                           .radius = kRadius});
                const BodyId floor = add_floor(model, 10, 0);
                State state = rest_state(model);
                const MoreauJean scheme(model,
                                        {.h = kLength / kCells / wave / 10, .solver = {.tolerance = 1e-12}},
                                        {.theta = 0.5, .law = NormalLaw::gap_over_step, .gamma = 0.5});
                const double fallen = kLength * kAccelerates * kFall, before = energy(model, state).total(),
                             speed = std::sqrt(2 * kAccelerates * kFall), touch = speed / kAccelerates,
                             contact = 2 * kLength / wave;
                double last = -kInf, ratio = 0, count = 0, off = kInf;
                int bounces = 0;
                run_accepted(scheme, state, kEnd, [&](const StepReport& report) {
                  const double sum = contact_force(report, floor).norm(), since = report.t - touch;
                  bounces += sum > 0 && report.t > last + contact;
                  if (sum > 0) last = report.t;
                  if (std::abs(since / contact - 0.5) < 0.25)  // where the grid no longer rings
                    ratio += sum / (wave * (speed + kAccelerates * (since - report.h / 2))), ++count;
                  if (std::abs(since / contact - 1.25) < 0.05)
                    off = momentum(model, state).linear.z() / kLength + kAccelerates * (since - contact) -
                          speed;
                  return true;
                });
                if (bounces < 3) throw NumericalFailure("the bar does not bounce three times");
                return Figures{{"energy", std::abs(energy(model, state).total() - before) / fallen},
                               {"force", std::abs(ratio / count - 1)},
                               {"speed", std::abs(off) / speed}};
              },
          .slow = true};
}

// A soft block that slides down a slope, in two sizes.
double sliding_acceleration(double size) {
  constexpr double kMu = 0.3;
  const double angle = kPi / 6;
  Model model;
  model.gravity = kGravity * Vec3(std::sin(angle), 0, -std::cos(angle));
  model.contact_law = {.mu = kMu};
  const VolumeMesh mesh = make_box_mesh(size * Vec3(1.4, 1.4, 0.52), {4, 4, 2});
  const double young = 1e6 * size, density = 1000;
  const Solid block =
      add_solid(model, mesh,
                {.materials = {{.young = young,
                                .poisson = 0.3,
                                .density = density,
                                .viscosity = 0.2 * young * size / std::sqrt(young / density)}},
                 .place = translation(0, 0, size * (0.26 + 0.01)),
                 .radius = 0.01 * size});
  add_floor(model, 100 * size, 0);
  State state = rest_state(model);
  const double second = std::sqrt(size);
  const MoreauJean scheme(model, {.h = 5e-3 * second, .solver = {.tolerance = 1e-12}},
                          {.theta = 1, .law = NormalLaw::gap_over_step});
  const auto speed = [&] {
    return momentum(model, state).linear.x() / (density * size * size * size * 1.4 * 1.4 * 0.52);
  };
  run_accepted(scheme, state, 2 * second);
  const double before = speed(), from = state.t;
  run_accepted(scheme, state, 3 * second);
  return (speed() - before) / (state.t - from) / (kGravity * (std::sin(angle) - kMu * std::cos(angle)));
}

VerificationCase block_on_slope() {
  return {
      .name = "F10.block_on_slope",
      .what = "soft block of 1.4 m x 1.4 m x 0.52 m, and a tenth of it, on a slope of 30 degrees, mu = 0.3",
      .rows = {{"large", "acceleration of the large one once it is at rest in itself, relative", "-", 1e-8,
                "g (sin - mu cos)"},
               {"small", "the same of the small one", "-", 1e-8, "g (sin - mu cos)"}},
      .measure =
          [] {
            return Figures{{"large", std::abs(sliding_acceleration(1) - 1)},
                           {"small", std::abs(sliding_acceleration(0.1) - 1)}};
          },
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> soft_contact_verification() {
  return {contact_patch(), bar_on_wall(), bouncing_bar(), block_on_slope()};
}

}  // namespace aussois
