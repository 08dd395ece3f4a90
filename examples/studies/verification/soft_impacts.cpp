// SPDX-License-Identifier: Apache-2.0
// Impacts of solids: rows F9 and F11.rings of group F (doc/theory/solids.md).
#include <algorithm>
#include <array>
#include <cmath>

#include "examples/scenes/solids.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

constexpr int kAlongRadius = 6;  // along a radius
constexpr double kShift = 0.6;   // of the middle of the grid towards the contact
constexpr double kSkin = 1e-4;   // of the surface

// Of the unit ball onto itself: conformal, so the cells keep their shapes; smallest at (0, 0, -1).
Vec3 shifted_down(const Vec3& x) {
  const Vec3 a = -kShift * Vec3::UnitZ();
  const double along = a.dot(x), a_a = a.squaredNorm(), x_x = x.squaredNorm();
  return ((1 - a_a) * x + (1 + x_x + 2 * along) * a) / (1 + 2 * along + a_a * x_x);
}

// The quarter x, y >= 0 of the unit ball.
VolumeMesh quarter_ball() {
  VolumeMesh out = make_box_mesh({1, 1, 2}, {kAlongRadius, kAlongRadius, 2 * kAlongRadius}, CellKind::hexes);
  for (Vec3& x : out.points) {
    x += Vec3(0.5, 0.5, 0);
    const double shell = x.cwiseAbs().maxCoeff();
    if (shell > 0) x *= shell / x.norm();
    x = shifted_down(x);
  }
  return out;
}

double volume_of(const VolumeMesh& mesh) {
  double sum = 0;
  for (const Hex& hex : mesh.hexes) sum += volume(mesh, hex);
  return sum;
}

VerificationCase ball_on_plane() {
  return {.name = "F9.ball_on_plane",
          .what =
              "a quarter of an elastic ball thrown against a rigid plane at a thousandth of sqrt(E / rho), "
              "where it touches without mass, gap over step on mean velocities, theta = 1/2",
          .rows = {{"time", "time of contact, relative", "-", 5e-2,
                    "Hertz: 2.868 (m^2 / (R E*^2 v))^(1/5); the contact grows to a twelfth of the radius"},
                   {"force", "largest force, relative", "-", 5e-2, "Hertz: 4/3 E* sqrt(R d^3)"},
                   {"speed", "speed of its centre after it, off", "-", 3e-2,
                    "Hertz: as before; vibrations take little at v << c"}},
          .measure =
              [] {
                constexpr double kPoisson = 0.3, kSpeed = 1e-3;
                constexpr double kStiffness = 1 / (1 - kPoisson * kPoisson);  // E* of E = 1
                constexpr double kMass = 4.0 / 3 * kPi;                       // of radius and density 1
                const VolumeMesh mesh = quarter_ball();
                SolidOptions options{
                    .materials = {{.young = 1, .poisson = kPoisson, .density = kMass / 4 / volume_of(mesh)}},
                    .place = translation(0, 0, 1 + kSkin + 1e-9),
                    .mean_volume = false,
                    .mass = SolidMass::redistributed,
                    .touching =
                        points_where(mesh, [](const Vec3& x) { return x.norm() > 1 - 1e-9 && x.z() < -0.8; }),
                    .radius = kSkin};
                hold(mesh, options, {true, false, false}, [](const Vec3& x) { return x.x() < 1e-9; });
                hold(mesh, options, {false, true, false}, [](const Vec3& x) { return x.y() < 1e-9; });
                Model model;
                model.gravity = Vec3::Zero();
                model.contact_law.mu = 0;
                const Solid ball = add_solid(model, mesh, options);
                const BodyId plane =
                    add(model, fixed_body("plane", add(model, prepare(dilate(make_plate(4, 4), 0)))));
                State state = rest_state(model);
                throw_solid(model, state, ball, -kSpeed * Vec3::UnitZ());
                const double deepest = std::pow(15 * kMass * kSpeed * kSpeed / (16 * kStiffness), 0.4);
                const double time = 2.943 * deepest / kSpeed,
                             force = 4.0 / 3 * kStiffness * std::pow(deepest, 1.5);
                const MoreauJean scheme(model, {.h = time / 150, .solver = {.tolerance = 1e-11}},
                                        {.theta = 0.5, .law = NormalLaw::gap_over_step, .gamma = 0.5});
                double begins = kInf, ends = 0, largest = 0;
                run_accepted(scheme, state, 1.2 * time, [&](const StepReport& report) {
                  const double now = 4 * contact_force(report, plane).norm();
                  if (now > 0) begins = std::min(begins, report.t - report.h), ends = report.t;
                  largest = std::max(largest, now);
                  return true;
                });
                return Figures{
                    {"time", std::abs((ends - begins) / time - 1)},
                    {"force", std::abs(largest / force - 1)},
                    {"speed", std::abs(momentum(model, state).linear.z() / (kMass / 4 * kSpeed) - 1)}};
              },
          .slow = true};
}

// A ring about y, one cell wide.
VolumeMesh make_ring(double inner, double outer, double width, int around, int through) {
  VolumeMesh out;
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k <= through; ++k)
      for (int i = 0; i < around; ++i) {
        const double angle = 2 * kPi * i / around, r = inner + (outer - inner) * k / through;
        out.points.emplace_back(r * std::cos(angle), width * (side - 0.5), r * std::sin(angle));
      }
  const auto at = [&](int side, int k, int i) { return i % around + around * (k + (through + 1) * side); };
  for (int k = 0; k < through; ++k)
    for (int i = 0; i < around; ++i) {
      Hex hex;
      for (int side = 0; side < 2; ++side) {
        const std::array<int, 4> face{at(side, k, i), at(side, k, i + 1), at(side, k + 1, i + 1),
                                      at(side, k + 1, i)};
        std::ranges::copy(face, hex.begin() + 4 * side);
      }
      out.hexes.push_back(hex);
    }
  turn_outside_out(out);
  return out;
}

VerificationCase ring_impact() {
  return {.name = "F11.rings",
          .what =
              "an elastic ring in plane strain thrown against another at a tenth of sqrt(E / rho), a little "
              "off its middle, without friction, until they have parted; gap over step on mean velocities, "
              "theta = "
              "1/2",
          .rows = {{"energy", "energy kept, off", "-", 1e-2,
                    "nothing dissipates but the impacts of surface points, of a tenth of the mass"},
                   {"momentum", "momentum kept, relative", "-", 1e-12, "nothing pushes from outside"}},
          .measure =
              [] {
                constexpr double kInner = 0.8, kOuter = 1, kWidth = 0.2, kSurface = 0.02, kSpeed = 0.1,
                                 kAside = 0.3;
                const VolumeMesh mesh = make_ring(kInner, kOuter, kWidth, 32, 4);
                SolidOptions options{.materials = {{.young = 1, .poisson = 0.3, .density = 1}},
                                     .mean_volume = false,
                                     .radius = kSurface};
                hold(mesh, options, {false, true, false}, [](const Vec3&) { return true; });
                Model model;
                model.gravity = Vec3::Zero();
                model.contact_law.mu = 0;
                add_solid(model, mesh, options);
                options.place = translation(kAside, 0, 2 * (kOuter + kSurface));
                const Solid thrown = add_solid(model, mesh, options);
                State state = rest_state(model);
                throw_solid(model, state, thrown, -kSpeed * Vec3::UnitZ());
                const double energy_before = energy(model, state).total();
                const Vec3 momentum_before = momentum(model, state).linear;
                const MoreauJean scheme(model, {.h = 0.05, .solver = {.tolerance = 1e-10}},
                                        {.theta = 0.5, .law = NormalLaw::gap_over_step, .gamma = 0.5});
                Worst off;
                run_accepted(scheme, state, 13, [&](const StepReport&) {
                  off.add(std::abs(energy(model, state).total() / energy_before - 1));
                  return true;
                });
                const Vec3 change = momentum(model, state).linear - momentum_before;
                return Figures{{"energy", off}, {"momentum", change.norm() / momentum_before.norm()}};
              },
          .slow = true};
}

}  // namespace

std::vector<VerificationCase> soft_impact_verification() {
  return {ball_on_plane(), ring_impact()};
}

}  // namespace aussois
