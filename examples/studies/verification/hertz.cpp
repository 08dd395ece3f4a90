// SPDX-License-Identifier: Apache-2.0
// Smooth contacts of solids: rows F3 and F11.ironing of group F (doc/theory/solids.md).
#include <algorithm>
#include <cmath>

#include "examples/scenes/solids.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

// A rounded block below z = 0 that is pressed by a rigid plane from above. Lengths in radii of the contact.
struct RoundedBlock {
  static constexpr double kRound = 200;                    // radius of its top
  static constexpr double kCell = 0.2, kGrowth = 1.4;      // where it touches, and from cell to cell outside
  static constexpr int kEven = 7, kCells = 15;             // along each axis, the first of one size
  static constexpr double kPoisson = 0.3, kRadius = 1e-4;  // of its surface
  static constexpr double kStiffness = 1 / (1 - kPoisson * kPoisson);  // E* of E = 1
  static double edge(int k) {
    const double even = kCell * std::min(k, kEven), grown = std::max(0, k - kEven);
    return even + kCell * kGrowth * (std::pow(kGrowth, grown) - 1) / (kGrowth - 1);
  }
  static double size() { return edge(kCells); }

  Model model{};
  State state{};
  BodyId plane{};

  // A ball's quarter, or half of a cylinder along y in plane strain. What is far off is displaced by `far`.
  RoundedBlock(bool ball, const std::function<Vec3(const Vec3&)>& far) {
    model.gravity = Vec3::Zero();
    model.contact_law.mu = 0;
    VolumeMesh mesh = make_box_mesh(Vec3::Ones(), {kCells, ball ? kCells : 1, kCells}, CellKind::hexes);
    for (Vec3& x : mesh.points) {
      const auto place = [&](int d, int cells) { return int(std::lround((x[d] + 0.5) * cells)); };
      const double along = edge(place(0, kCells)),
                   across = ball ? edge(place(1, kCells)) : kCell * place(1, 1),
                   deep = edge(kCells - place(2, kCells));
      const double lower = (along * along + (ball ? across * across : 0)) / (2 * kRound);
      x = {along, across, -deep - lower * (1 - deep / size())};
    }
    SolidOptions options{.materials = {{.young = 1, .poisson = kPoisson, .density = 1}}, .radius = kRadius};
    const auto outside = [&](const Vec3& x) {
      return x.x() > size() - 1e-9 || (ball && x.y() > size() - 1e-9) || x.z() < 1e-9 - size();
    };
    hold(mesh, options, {true, false, false}, [](const Vec3& x) { return x.x() < 1e-9; });
    hold(mesh, options, {false, true, false}, [&](const Vec3& x) { return !ball || x.y() < 1e-9; });
    hold(mesh, options, {true, true, true}, outside);
    const Solid block = add_solid(model, mesh, options);
    plane = add(model, RigidBody{.name = "plane",
                                 .shape = add(model, prepare(dilate(make_plate(40, 40), 0))),
                                 .motion = DrivenMotion{}});
    state = rest_state(model);
    pose(state, plane).p.z() = kRadius;
    const int first = first_coordinate(model, block.points);
    for (const int p : points_where(mesh, outside))
      state.q.segment<3>(first + 3 * Eigen::Index(p)) = far(mesh.points[std::size_t(p)]);
  }

  // The force on the plane, and the sum of force times distance squared from the middle over it.
  struct Pressed {
    double force = 0, spread = 0;
  };
  Pressed press(double approach) {
    const MoreauJean scheme(model, {.h = 1e4, .solver = {.tolerance = 1e-10}},
                            {.theta = 1, .law = NormalLaw::gap_over_step});
    constexpr int kSteps = 5;
    linear_part(state.v, plane).z() = -approach / (kSteps * 1e4);
    run_accepted(scheme, state, kSteps * 1e4);
    linear_part(state.v, plane).z() = 0;
    StepReport report;
    for (int k = 0; k < 4; ++k) report = step(scheme, state);
    Pressed out{.force = contact_force(report, plane).z()};
    for (const StepContact& c : report.contacts)
      out.spread += std::abs(c.impulse.z()) / report.h * c.point.x_a.head<2>().squaredNorm() / out.force;
    return out;
  }
};

// Of a half-space z < 0 that a force pushes down at the origin (Boussinesq).
Vec3 boussinesq(const Vec3& x, double force, double poisson) {
  const double deep = -x.z(), rho = x.norm(), scale = force * (1 + poisson) / (2 * kPi),
               outwards = scale * (deep / std::pow(rho, 3) - (1 - 2 * poisson) / (rho * (rho + deep))),
               down = scale * (deep * deep / std::pow(rho, 3) + 2 * (1 - poisson) / rho);
  return {outwards * x.x(), outwards * x.y(), -down};
}

VerificationCase hertz_ball() {
  return {.name = "F3.ball",
          .what =
              "a quarter of a rounded block, ten cells across the contact, pressed by a rigid plane without "
              "friction; its far sides are displaced as those of a half-space",
          .rows = {{"force", "force at a given approach, relative", "-", 1e-2,
                    "Hertz: 4/3 E* sqrt(R d^3); Boussinesq far off"},
                   {"radius", "radius of the contact, from the spread of its pressure, relative", "-", 3e-2,
                    "Hertz: sqrt(R d)"}},
          .measure =
              [] {
                const double approach = 1 / RoundedBlock::kRound,
                             exact = 4.0 / 3 * RoundedBlock::kStiffness / RoundedBlock::kRound;
                RoundedBlock block(
                    true, [&](const Vec3& x) { return boussinesq(x, exact, RoundedBlock::kPoisson); });
                const auto [force, spread] = block.press(approach);
                return Figures{{"force", std::abs(4 * force / exact - 1)},
                               {"radius", std::abs(std::sqrt(2.5 * spread) - 1)}};
              },
          .slow = true};
}

VerificationCase hertz_line() {
  return {.name = "F3.line",
          .what =
              "half of a block rounded like a cylinder, in plane strain, some ten cells across the contact, "
              "pressed by a rigid plane without friction",
          .rows = {{"width", "half width of the contact, from the spread of its pressure, relative", "-",
                    3e-2, "Hertz: sqrt(4 F R / (pi E* L))"}},
          .measure = [] {
            RoundedBlock block(false, [](const Vec3&) -> Vec3 { return Vec3::Zero(); });
            const auto [force, spread] = block.press(2.2 / RoundedBlock::kRound);
            const double exact = std::sqrt(4 * (2 * force / RoundedBlock::kCell) * RoundedBlock::kRound /
                                           (kPi * RoundedBlock::kStiffness));
            return Figures{{"width", std::abs(2 * std::sqrt(spread) / exact - 1)}};
          }};
}

// A rigid roller that is pressed into a slab and pushed along it, in plane strain.
VerificationCase ironing() {
  return {
      .name = "F11.ironing",
      .what =
          "a rigid roller that does not turn, pressed into a slab of hexahedra, ten cells across the "
          "contact, and pushed over four of them, mu = 0.3",
      .rows = {{"ripple", "largest force across the slab off its mean, relative", "-", 3e-2,
                "the slab is the same all along but for its cells"},
               {"along", "the same of the force along it", "-", 3e-2, "the same"}},
      .measure =
          [] {
            constexpr double kCell = 1.0 / 16, kRoller = 1, kMu = 0.3, kRadius = 1e-4, kDeep = 0.08,
                             kStep = 1e3;
            constexpr int kPerCell = 4, kLead = 3, kCells = 4;
            Model model;
            model.gravity = Vec3::Zero();
            model.contact_law.mu = kMu;
            const VolumeMesh mesh = make_box_mesh({2.5, kCell, 0.625}, {40, 1, 10}, CellKind::hexes);
            SolidOptions options{.materials = {{.young = 1, .poisson = 0.3, .density = 1}},
                                 .radius = kRadius};
            hold(mesh, options, {false, true, false}, [](const Vec3&) { return true; });
            hold(mesh, options, {true, true, true}, [](const Vec3& x) { return x.z() < 1e-9 - 0.3125; });
            add_solid(model, mesh, options);
            SimplicialComplex axis = make_polyline({Vec3(0, -2 * kCell, 0), Vec3(0, 2 * kCell, 0)});
            const BodyId roller = add(model, RigidBody{.name = "roller",
                                                       .shape = add(model, prepare(dilate(axis, kRoller))),
                                                       .motion = DrivenMotion{}});
            State state = rest_state(model);
            pose(state, roller).p = {-kCells * kCell / 2, 0, 0.3125 + kRadius + kRoller};
            const MoreauJean scheme(model, {.h = kStep, .solver = {.tolerance = 1e-10}},
                                    {.theta = 1,
                                     .law = NormalLaw::gap_over_step,
                                     .newton = {.max_iterations = 4, .tolerance = 1e-7}});
            const double pressing = 5;
            linear_part(state.v, roller).z() = -kDeep / (pressing * kStep);
            run_accepted(scheme, state, pressing * kStep);
            linear_part(state.v, roller) = kCell / (kPerCell * kStep) * Vec3::UnitX();
            run_accepted(scheme, state, state.t + kLead * kPerCell * kStep);
            std::vector<Vec3> forces;
            Vec3 mean = Vec3::Zero();
            run_accepted(scheme, state, state.t + kCells * kPerCell * kStep, [&](const StepReport& report) {
              forces.push_back(contact_force(report, roller));
              mean += forces.back();
              return true;
            });
            mean /= double(forces.size());
            Worst across, along;
            for (const Vec3& f : forces) {
              across.add(std::abs(f.z() / mean.z() - 1));
              along.add(std::abs(f.x() / mean.x() - 1));
            }
            return Figures{{"ripple", across}, {"along", along}};
          },
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> hertz_verification() {
  return {hertz_ball(), hertz_line(), ironing()};
}

}  // namespace aussois
