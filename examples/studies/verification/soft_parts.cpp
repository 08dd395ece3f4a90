// SPDX-License-Identifier: Apache-2.0
// Soft parts pressed, snapped and stacked: rows F12 to F14 of group F (doc/theory/solids.md).
#include "examples/scenes/soft_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

// The largest distance of a point from the mirror image of the one across.
double unlike_its_image(const RingBetweenPlates& s) {
  Worst out;
  const Vec3 across(1, 1, -1);
  const std::vector<Vec3>&laid = s.ring.mesh->points, x = solid_places(s.model, s.state, s.ring);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < x.size(); ++k)
      if ((laid[k] - laid[i].cwiseProduct(across)).norm() < 1e-9)
        out.add((x[k] - x[i].cwiseProduct(across)).norm());
  return out;
}

// Force of a snap-fit along x over that along y on the ramp.
double force_ratio() {
  return (SnapFit::kMu + SnapFit::slope()) / (1 - SnapFit::kMu * SnapFit::slope());
}
// Force that lifts the tooth so far; that of the insertion bends it back.
double lifting_force() {
  using S = SnapFit;
  const double EI = S::kYoung * S::kWide * std::pow(S::kHeight, 3) / 12, arm = S::kHeight / 2 + S::kTooth;
  return 3 * EI * S::kLift / std::pow(S::kPeak, 3) / (1 - 1.5 * arm / S::kPeak * force_ratio());
}

VerificationCase squeezed_ring() {
  return {
      .name = "F12.o_ring",
      .what =
          "a rubber ring 5 mm thick on a diameter of 50 mm, 8 hexahedra across, squeezed between plates by "
          "up to a quarter, without friction",
      .rows = {{"force", "worst force at 10, 15, 20 and 25 %, relative", "-", 0.1,
                "pi D d E (1.25 C^1.5 + 50 C^6), a fit to measurements (Lindley 1967)"},
               {"both", "force of one plate off that of the other, relative", "-", 1e-6, "equilibrium"},
               {"mirrored", "largest place off its mirror image, over the thickness", "-", 1e-6,
                "symmetry of ring and plates"}},
      .measure =
          [] {
            constexpr double kYoung = 5e6, kSpeed = 5e-4;
            RingBetweenPlates s(kYoung);
            const MoreauJean scheme(s.model, {.h = 1e-2}, {.theta = 1, .law = NormalLaw::gap_over_step});
            Worst off, both;
            for (const double part : {0.1, 0.15, 0.2, 0.25}) {
              const double way = (part - 1) * s.kThick / 2 - pose(s.state, s.plates[0]).p.z();
              s.press_at(kSpeed);
              run_accepted(scheme, s.state, s.state.t + way / kSpeed);
              s.press_at(0);
              StepReport report;
              for (int k = 0; k < 10; ++k) report = step(scheme, s.state);
              const double upper = contact_force(report, s.plates[1]).z(),
                           lower = contact_force(report, s.plates[0]).z(),
                           exact = kPi * s.kDiameter * s.kThick * kYoung *
                                   (1.25 * std::pow(part, 1.5) + 50 * std::pow(part, 6));
              off.add(std::abs(4 * upper / exact - 1));
              both.add(std::abs(lower / upper + 1));
            }
            return Figures{{"force", off}, {"both", both}, {"mirrored", unlike_its_image(s) / s.kThick}};
          },
      .slow = true};
}

VerificationCase snapped() {
  return {
      .name = "F13.snap_fit",
      .what =
          "a cantilever of 50 mm x 2.5 mm with a tooth at its end, 4 smoothed cells through it, passed by a "
          "catch with a ramp of 30 degrees that lifts it by 0.8 mm, mu = 0.2",
      .rows =
          {{"ratio", "force of insertion over the lifting force on the ramp, relative", "-", 1e-8,
            "Coulomb: (mu + tan a) / (1 - mu tan a)"},
           {"insertion", "largest force of insertion, relative", "-", 5e-2,
            "that ratio times 3 E I y / L^3 with the moment of the force on the tooth; small deflections"},
           {"flat", "force over the flat of the catch over the lifting force, off mu, relative", "-", 1e-8,
            "Coulomb"},
           {"behind", "force behind the catch", "N", 0, "it no longer touches"}},
      .measure =
          [] {
            constexpr double kStep = 5e-5;
            SnapFit s(kStep);
            const double ramp = s.ramp();
            const MoreauJean scheme(s.model, {.h = 1, .solver = {.tolerance = 1e-10}},
                                    {.theta = 1,
                                     .law = NormalLaw::gap_over_step,
                                     .newton = {.max_iterations = 12, .tolerance = 1e-9}});
            Worst ratio, flat, insertion;
            double behind = kInf;
            run_accepted(scheme, s.state, std::round((ramp + s.kFlat + 3e-3) / kStep),
                         [&](const StepReport& report) {
                           const Vec3 f = contact_force(report, s.caught);
                           const double at = s.passed(), along = -f.x() / f.y();
                           insertion.add(std::max(0.0, f.x()));
                           if (at > 0.4 * ramp && at < 0.8 * ramp)
                             ratio.add(std::abs(along / force_ratio() - 1));
                           if (at > ramp + 0.3 * s.kFlat && at < ramp + 0.7 * s.kFlat)
                             flat.add(std::abs(along / s.kMu - 1));
                           behind = f.norm();
                           return true;
                         });
            return Figures{{"ratio", ratio},
                           {"insertion", std::abs(insertion / (force_ratio() * lifting_force()) - 1)},
                           {"flat", flat},
                           {"behind", behind}};
          },
      .slow = true};
}

// Soft cubes on top of each other.
VerificationCase cube_stack() {
  return {
      .name = "F14.stack",
      .what =
          "twelve soft cubes of 10 cm, one cell each, fall onto each other by 1 mm, mu = 0.3, and come to "
          "rest",
      .rows = {{"force", "force of the floor off their weight, relative", "-", 1e-8, "equilibrium"},
               {"sinks",
                "way down of the highest cube's middle, over what its weight and that of those below "
                "compress, off one",
                "-", 0.1, "Hooke: rho g H^2 / (2 E); bulging and friction are small"}},
      .measure =
          [] {
            constexpr double kSize = 0.1, kYoung = 2e7, kDensity = 1000, kRadius = 1e-3, kGap = 1e-3;
            constexpr int kCubes = 12;
            Model model;
            model.contact_law.mu = 0.3;
            const VolumeMesh mesh = make_box_mesh(Vec3::Constant(kSize), {1, 1, 1});
            std::vector<Solid> cubes;
            for (int k = 0; k < kCubes; ++k)
              cubes.push_back(add_solid(
                  model, mesh,
                  {.materials = {{.young = kYoung, .poisson = 0.3, .density = kDensity, .viscosity = 2e5}},
                   .place =
                       translation(0, 0, kRadius + kSize / 2 + k * (kSize + 2 * kRadius) + (k + 1) * kGap),
                   .radius = kRadius}));
            const BodyId floor =
                add(model, RigidBody{.name = "floor",
                                     .shape = add(model, prepare(dilate(make_plate(2, 2), 0))),
                                     .motion = FixedMotion{}});
            State state = rest_state(model);
            const MoreauJeanOptions own{.theta = 1, .law = NormalLaw::gap_over_step};
            run_accepted(MoreauJean(model, {.h = 5e-3}, own), state, 0.3);
            const MoreauJean slow(model, {.h = 5e-2, .solver = {.tolerance = 1e-10}}, own);
            StepReport report;
            run_accepted(slow, state, 6, [&](const StepReport& r) {
              report = r;
              return true;
            });
            const double weight = kCubes * kDensity * std::pow(kSize, 3) * kGravity;
            const std::vector<Vec3> top = solid_places(model, state, cubes.back());
            double height = 0;
            for (const Vec3& x : top) height += x.z() / double(top.size());
            const double laid = kRadius + kSize / 2 + (kCubes - 1) * (kSize + 2 * kRadius),
                         H = kCubes * kSize, below = H - kSize / 2,
                         exact = kDensity * kGravity / kYoung * (H * below - below * below / 2);
            return Figures{{"force", std::abs(contact_force(report, floor).z() / weight + 1)},
                           {"sinks", std::abs((laid - height) / exact - 1)}};
          },
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> soft_part_verification() {
  return {squeezed_ring(), snapped(), cube_stack()};
}

}  // namespace aussois
