// SPDX-License-Identifier: Apache-2.0
// Loose knots in thin rods: rows K5 and K6.slope of group K (doc/theory/beams.md).
#include <algorithm>
#include <cmath>

#include "examples/scenes/beams.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

constexpr double kTail = 5;     // of a knot [m]
constexpr double kForce = 0.5;  // B / (2 R^2) [N]

// A rod of bending stiffness 1 N m^2, tied to an overhand knot: a loop of 1 m radius whose two ends wind
// three half turns about each other along x, between straight tails. Its first end is held.
struct LooseKnot {
  Model model{};
  State state{};
  Cable rod{};
  DeadLoad pull{};  // along x on its last end, times its factor
  LooseKnot(double radius, double spacing) {
    model.gravity = Vec3::Zero();
    model.contact_law.mu = 0;
    const double braid = 6 * std::sqrt(radius), apart = 1.5 * radius;
    std::vector<Vec3> line;
    // A strand along x that lies on the other side after three half turns
    const auto aside = [&](double x, double side) -> Vec3 {
      const double part = std::clamp(x / braid + 0.5, 0.0, 1.0), smooth = part * part * (3 - 2 * part),
                   angle = kPi * (3 * smooth - 0.5);
      return side * apart * Vec3(0, std::sin(angle), std::cos(angle));
    };
    const double fine = spacing / 8;
    for (double x = -kTail; x < 0; x += fine) line.push_back(Vec3(x, 0, 0) + aside(x, 1));
    for (double s = 0; s < 2 * kPi; s += fine)
      line.push_back(Vec3(std::sin(s), 1 - std::cos(s), 0) +
                     aside(s < kPi ? s : s - 2 * kPi, s < kPi ? 1 : -1));
    for (double x = 0; x < kTail; x += fine) line.push_back(Vec3(x, 0, 0) + aside(x, -1));
    const int elements = int(std::ceil((2 * kTail + 2 * kPi) / spacing));
    rod = add_cable(
        model, {.name = "rod",
                .nodes = frames_along(points_along(line, elements + 1)),
                .section = section_of(
                    {.EA = 1e6, .GA = 1e6, .GJ = 1, .EI = 1, .mass = 1e-2, .about_x = 2e-6, .across = 1e-6}),
                .radius = radius,
                .touches_itself = true,
                .straight = true});
    model.bodies[rod.nodes.front()].motion = FixedMotion{};
    pull = {.body = rod.nodes.back(), .force = Vec3::UnitX()};
    add(model, pull);
    state = rest_state(model);
    lay(rod, state);
  }
  // The radius of its loop: from the mean curvature of the quarter opposite to where it winds.
  double loop_radius() const {
    const std::vector<BeamLoad> loads = beam_loads(rod.beam, state);
    double sum = 0, count = 0;
    const std::size_t middle = loads.size() / 2,
                      eighth = std::size_t(double(loads.size()) * kPi / 4 / (2 * kTail + 2 * kPi));
    for (std::size_t i = middle - eighth; i < middle + eighth; ++i)
      sum += loads[i].strain.tail<2>().norm(), ++count;
    return count / sum;
  }
};

// Goes to rest without friction under a force of 1/2 N at its free end: the knot would have a loop of 1 m if
// it were infinitely thin. Contacts come and go for ever where strands slide over joints of elements; what
// they do to the loop is far below the bounds.
StepReport come_to_rest(LooseKnot& knot) {
  constexpr int kSteps = 80;
  *knot.pull.factor = kForce;
  const MoreauJean scheme(knot.model, {.h = 1}, {.theta = 1});
  StepReport report;
  double h = 1e-4;
  for (int k = 0; k < kSteps; ++k) {
    knot.state.h_next = 0;
    report = step(scheme, knot.state, h);
    h = (report.attempts == 1 ? 1.5 : 0.7) * report.h;
  }
  return report;
}

VerificationCase loose_knot() {
  return {
      .name = "K5.loose_knot",
      .what = "overhand knot in a rod without friction, its radius r 1e-3 and 4e-3 of the loop's, pulled",
      .rows = {{"force", "F R^2 / B with 1e-3 off one half, relative", "-", 5e-2,
                "the limit of thin rods: a loop that is a circle (Audoly, Clauvelin and Neukirch 2007)"},
               {"limit", "the same, extrapolated in sqrt(r / R)", "-", 1e-2, "the same"},
               {"contacts", "contacts that bear", "-", 3, "a knot crosses itself thrice", Sense::at_least}},
      .measure =
          [] {
            LooseKnot thin(1e-3, 0.015), thick(4e-3, 0.03);
            come_to_rest(thick);
            int bearing = 0;
            for (const StepContact& c : come_to_rest(thin).contacts) bearing += c.impulse.norm() > 0;
            const double of_thin = kForce * std::pow(thin.loop_radius(), 2),
                         of_thick = kForce * std::pow(thick.loop_radius(), 2);
            return Figures{{"force", std::abs(2 * of_thin - 1)},
                           {"limit", std::abs(2 * (2 * of_thin - of_thick) - 1)},
                           {"contacts", bearing}};
          },
      .slow = true};
}

// F R^2 of a knot with friction that is drawn tighter (1) or let go (-1) until all of it slips, on average.
double drawn(LooseKnot knot, double mu, int direction) {
  constexpr int kSteps = 30, kOnset = 10;
  constexpr double kWay = 0.15;  // [m]
  knot.model.contact_law.mu = mu;
  const BodyId end = knot.rod.nodes.back();
  knot.model.bodies[end].motion = DrivenMotion{};
  knot.state.v.setZero();
  knot.state.t = 0;
  linear_part(knot.state.v, end) = direction * kWay / kSteps * Vec3::UnitX();
  const MoreauJean scheme(knot.model, {.h = 1}, {.theta = 1});
  double sum = 0, time = 0;
  run_accepted(scheme, knot.state, kSteps, [&](const StepReport& report) {
    if (knot.state.t <= kOnset) return true;
    const double tension = beam_loads(knot.rod.beam, knot.state).back().stress[0];
    sum += report.h * tension * std::pow(knot.loop_radius(), 2), time += report.h;
    return true;
  });
  return sum / time;
}

VerificationCase rough_knot() {
  return {.name = "K6.slope",
          .what = "overhand knot, r / R = 4e-3, mu = 0.02, drawn tighter and let go until all of it slips",
          .rows = {{"friction",
                    "half the difference of both forces, less that without friction, over mu times what the "
                    "strands press on each other, off one",
                    "-", 0.1, "virtual work at small mu: they slide by as much as the ends move"},
                   {"corners", "half the difference without friction, over the force", "-", 0.1,
                    "joints of elements that slide over each other; none in thin rods that are smooth"}},
          .measure =
              [] {
                constexpr double kMu = 0.02;
                LooseKnot knot(4e-3, 0.03);
                const StepReport report = come_to_rest(knot);
                double press = 0;
                for (const StepContact& c : report.contacts) press += c.impulse.norm() / report.h;
                const double size = std::pow(knot.loop_radius(), 2),
                             smooth = (drawn(knot, 0, 1) - drawn(knot, 0, -1)) / 2,
                             rough = (drawn(knot, kMu, 1) - drawn(knot, kMu, -1)) / 2;
                return Figures{{"friction", std::abs((rough - smooth) / (kMu * press * size) - 1)},
                               {"corners", smooth / (kForce * size)}};
              },
          .slow = true};
}

}  // namespace

std::vector<VerificationCase> knot_verification() {
  return {loose_knot(), rough_knot()};
}

}  // namespace aussois
