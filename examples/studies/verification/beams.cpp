// SPDX-License-Identifier: Apache-2.0
// Group E: geometrically exact beams (doc/theory/beams.md).
#include "examples/scenes/beams.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "examples/studies/verification/mesh_study.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/forces.hpp"

namespace aussois {
namespace {

// Steps of theta = 1 that end in an equilibrium: long beside every motion of these beams.
MoreauJean static_scheme(const Model& model) {
  return MoreauJean(model, {.h = 1e4}, {.theta = 1});
}
void settle_accepted(const Model& model, State& state) {
  require_accepted(settle(static_scheme(model), state));
}

// An implicit step solved to its end, or in one iteration.
MoreauJean dynamic_scheme(const Model& model, double h, bool looped) {
  return MoreauJean(
      model, {.h = h, .solver = {.tolerance = 1e-12}},
      looped ? MoreauJeanOptions{.theta = 0.5, .newton = {.max_iterations = 12, .tolerance = 1e-11}}
             : MoreauJeanOptions{.theta = 0.5});
}
PassiveMidpoint conserving_scheme(const Model& model, double h) {
  return PassiveMidpoint(model, {.h = h, .solver = {.tolerance = 1e-12}, .update = GroupUpdate::cayley},
                         {.forces = MiddleForce::conserving});
}

// A cantilever of 10 m along x whose tip is turned about z by a moment: a circle of constant curvature.
VerificationCase rolled_up(const std::string& name, double turn, int elements, const Vec3& tip) {
  return {.name = name,
          .setting = std::to_string(elements) + " elements",
          .what = "cantilever whose tip is turned by a moment, in 20 steps of the load",
          .rows = {{"tip", "tip off its place on the circle, over the length", "-", 1e-10,
                    "closed form: constant curvature, which an element holds exactly"}},
          .measure = [=] {
            constexpr double kLength = 10;
            const BeamNumbers numbers{
                .EA = 1e4, .GA = 1e4, .GJ = 100, .EI = 100, .mass = 1, .about_x = 2e-2, .across = 1e-2};
            BeamScene s =
                beam_scene(straight_nodes(Vec3::Zero(), kLength * Vec3::UnitX(), elements), numbers, true);
            const DeadLoad load{.body = s.last(), .moment = turn * numbers.EI / kLength * Vec3::UnitZ()};
            add(s.model, load);
            for (int k = 1; k <= 20; ++k) {
              *load.factor = k / 20.0;
              settle_accepted(s.model, s.state);
            }
            return Figures{{"tip", (pose(s.state, s.last()).p / kLength - tip).norm()}};
          }};
}

// An eighth of a circle of 100 m in the plane, 1 m square, nodes on the circle. (Bathe and Bolourchi 1979)
BeamScene bend45(int elements) {
  std::vector<SE3> nodes;
  for (int i = 0; i <= elements; ++i) {
    const double angle = kPi / 4 * i / elements;  // tangent +y at the clamp, bends towards +x
    Mat3 R;
    R << Vec3(std::sin(angle), std::cos(angle), 0), Vec3(-std::cos(angle), std::sin(angle), 0), Vec3::UnitZ();
    nodes.push_back({Quat(R), 100 * Vec3(1 - std::cos(angle), std::sin(angle), 0)});
  }
  return beam_scene(
      nodes,
      {.EA = 1e7, .GA = 5e6, .GJ = 5e6 / 6, .EI = 1e7 / 12, .mass = 1, .about_x = 1. / 6, .across = 1. / 12},
      true);
}

Vec3 bend45_tip(int elements, const std::vector<double>& course) {
  BeamScene s = bend45(elements);
  const DeadLoad load{.body = s.last(), .force = Vec3::UnitZ()};
  add(s.model, load);
  for (const double force : course) {
    *load.factor = force;
    settle_accepted(s.model, s.state);
  }
  return pose(s.state, s.last()).p;
}

MeshStudy bends() {
  return {.name = "E2.bend_of_45_degrees",
          .error_of = "tip under 600 N",
          .unit = "m",
          .counted = "elements",
          .sizes = {8, 16, 32, 64},
          .error = [](int elements) {
            const std::vector<SeriesRow> rows = shared_series("beam_bend45.csv", "G=E/2; J=1/6; GA=5e6");
            const SeriesRow& row = row_where(rows, "F", 600);
            return (bend45_tip(elements, {200, 400, 600}) -
                    Vec3(row.at("tip_x"), row.at("tip_y"), row.at("tip_z")))
                .norm();
          }};
}

VerificationCase bend_of_45_degrees() {
  return {.name = "E2.bend_of_45_degrees",
          .what = "an eighth of a circle of 100 m, 600 N at its tip out of its plane",
          .rows = {{"tip16", "tip with 16 elements off", "m", 0.042,
                    "shared series; a prototype of the same element"},
                   {"tip64", "tip with 64 elements off", "m", 0.0027,
                    "shared series; a prototype of the same element"},
                   {"order", "fitted order, 8 to 64 elements", "-", 1.95, "theory: 2", Sense::at_least},
                   {"path", "tip after a detour by -500 and 900 N", "m", 1e-10,
                    "theory: forces depend on the places alone"}},
          .measure = [] {
            const Convergence off = measured(bends());
            const Vec3 straight = bend45_tip(16, {200, 400, 600}),
                       round = bend45_tip(16, {-250, -500, 300, 900, 600});
            return Figures{{"tip16", off.error[1]},
                           {"tip64", off.error[3]},
                           {"order", off.order},
                           {"path", (round - straight).norm()}};
          }};
}

// A free beam of 10 m that leans, its low end at (6, 0). (Simo and Vu-Quoc 1986)
BeamScene leaning_beam(int elements, double EI) {
  return beam_scene(straight_nodes({6, 0, 0}, {0, 8, 0}, elements),
                    {.EA = 1e4, .GA = 1e4, .GJ = EI, .EI = EI, .mass = 1, .about_x = 20, .across = 10},
                    false);
}

// It is pushed and turned at its low end in the plane for 2.5 s.
struct FlyingBeam {
  BeamScene scene{};
  FlyingBeam(int elements, double EI) : scene(leaning_beam(elements, EI)) {
    add(scene.model,
        DeadLoad{.body = scene.first(), .force = {8, 0, 0}, .moment = {0, 0, -80}, .course = [](double t) {
                   return t < 2.5 ? 1.0 : 0.0;
                 }});
  }
  double energy_now() const { return energy(scene.model, scene.state).total(); }
  double momentum_x() const {
    double sum = 0;
    for (const BodyId node : scene.cable.nodes)
      sum += scene.model.bodies[node].mass * linear_part(scene.state.v, node).x();
    return sum;
  }
};

Figures fly(bool looped, double h) {
  FlyingBeam beam(40, 500);
  BeamScene& s = beam.scene;
  const MoreauJean scheme = dynamic_scheme(s.model, h, looped);
  run_accepted(scheme, s.state, 2.5);
  const std::vector<SeriesRow> rows = shared_series("flying_beam_EI500.csv");
  const SeriesRow& row = row_where(rows, "t_s", 2.5);
  const Vec3 low(row.at("extrapolated_x_low"), row.at("extrapolated_y_low"), 0);
  Figures out{{"low_end", (pose(s.state, s.first()).p - low).norm()},
              {"momentum", std::abs(beam.momentum_x() - 20)}};
  const double after = beam.energy_now();
  Worst change;
  run_accepted(scheme, s.state, 5, [&](const StepReport&) {
    change.add(std::abs(beam.energy_now() - after) / after);
    return true;
  });
  out["energy"] = change;
  return out;
}

VerificationCase flying_beam(bool looped, double h, double energy_bound, std::vector<Asked> more) {
  std::vector<Asked> rows{{"momentum", "momentum along x off 20 N s after the load", "N s", 1e-11,
                           "exact: force times time; rounding"},
                          {"energy", "energy from 2.5 s to 5 s off its value after the load, relative", "-",
                           energy_bound, "kept but for the order in h"}};
  rows.insert(rows.end(), more.begin(), more.end());
  return {.name = "E3.flying_beam",
          .setting = looped ? "midpoint solved to its end" : "one iteration",
          .what = "free beam of 40 elements, EI = 500 N m^2, pushed and turned for 2.5 s; h = " +
                  number_text(1e3 * h) + " ms",
          .rows = rows,
          .measure = [=] { return fly(looped, h); },
          .slow = true};
}

// EI = 100 N m^2: places of the low end by planar beams of another kind (strains at the middle of elements,
// angles as coordinates), 160 and 320 of them, extrapolated; they differ by 2e-4 m at 2.5 s, 1e-3 m at 8 s.
VerificationCase flying_spaghetti() {
  return {
      .name = "E4.spaghetti",
      .what =
          "the free beam of E3 with EI = 100 N m^2, midpoint solved to its end, 20, 40 and 80 elements with "
          "h = 10, 5 and 2.5 ms",
      .rows = {{"at_2500_ms", "low end at 2.5 s with 80 elements", "m", 6e-4,
                "a planar model of another kind; a prototype: 4e-4"},
               {"at_8_s", "low end at 8 s with 80 elements", "m", 4e-3,
                "a planar model of another kind; a prototype: 3.2e-3"},
               {"order", "fitted order of the low end at 2.5 s", "-", 1.9, "theory: 2", Sense::at_least},
               {"momentum", "momentum along x off 20 N s after the load, relative", "-", 1e-12,
                "exact: force times time; rounding"},
               {"energy", "energy from 2.5 s to 8 s off its value after the load, 80 elements, relative", "-",
                1e-5, "kept but for the order in h"}},
      .measure =
          [] {
            std::vector<double> l, off;
            Figures out;
            for (const int n : {20, 40, 80}) {
              FlyingBeam beam(n, 100);
              BeamScene& s = beam.scene;
              const MoreauJean scheme = dynamic_scheme(s.model, 0.2 / n, true);
              run_accepted(scheme, s.state, 2.5);
              l.push_back(1.0 / n);
              off.push_back((pose(s.state, s.first()).p - Vec3(4.963077, 4.476001, 0)).norm());
              out["momentum"] = std::abs(beam.momentum_x() / 20 - 1);
              if (n < 80) continue;
              const double after = beam.energy_now();
              Worst change;
              run_accepted(scheme, s.state, 8, [&](const StepReport&) {
                change.add(std::abs(beam.energy_now() / after - 1));
                return true;
              });
              out["energy"] = change;
              out["at_8_s"] = (pose(s.state, s.first()).p - Vec3(13.331836, 1.031742, 0)).norm();
            }
            out["at_2500_ms"] = off.back(), out["order"] = fitted_order(l, off);
            return out;
          },
      .slow = true};
}

VerificationCase tumbling_beam(bool conserving) {
  const std::string why = conserving ? "exact (PMI-9) to (PMI-12); rounding" : "kept but for the order in h";
  return {
      .name = "E4.tumbling",
      .setting = conserving ? "passive_midpoint, conserving forces" : "midpoint solved to its end",
      .what = "a free beam pushed and turned out of its plane for 5 s, 20 elements, 2.5 ms, to 10 s",
      .rows = {{"linear", "momentum off 50 N s along x after the load, relative", "-", 1e-12,
                "exact: force times time; rounding"},
               {"angular", "largest change of the angular momentum from 5 s to 10 s, relative", "-",
                conserving ? 1e-12 : 1e-6, why + (conserving ? "" : "; a prototype: 8e-7")},
               {"energy", "energy from 5 s to 10 s off its value after the load, relative", "-",
                conserving ? 1e-12 : 1e-4, why}},
      .measure =
          [conserving] {
            BeamScene s = leaning_beam(20, 500);  // (Simo and Vu-Quoc 1988)
            add(s.model,
                DeadLoad{.body = s.first(),
                         .force = {20, 0, 0},
                         .moment = {0, -200, -100},
                         .course = [](double t) { return std::max(0.0, 1 - std::abs(t / 2.5 - 1)); }});
            const auto run_until = [&, looped = dynamic_scheme(s.model, 2.5e-3, true),
                                    kept = conserving_scheme(s.model, 2.5e-3)](double t, const auto& go_on) {
              if (conserving)
                run_accepted(kept, s.state, t, go_on);
              else
                run_accepted(looped, s.state, t, go_on);
            };
            run_until(5, [](const StepReport&) { return true; });
            const Momentum start = momentum(s.model, s.state);
            const double after = energy(s.model, s.state).total();
            Worst angular, change;
            run_until(10, [&](const StepReport&) {
              angular.add((momentum(s.model, s.state).angular - start.angular).norm() / start.angular.norm());
              change.add(std::abs(energy(s.model, s.state).total() / after - 1));
              return true;
            });
            return Figures{{"linear", (start.linear / 50 - Vec3::UnitX()).norm()},
                           {"angular", angular},
                           {"energy", change}};
          },
      .slow = true};
}

// Legs of 10 m along x and then y, pushed at the elbow out of their plane. (Simo and Vu-Quoc 1988)
struct RightAngle {
  BeamScene scene{};
  BodyId elbow{};
  explicit RightAngle(int leg)
      : scene(legs_scene(
            {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, leg,
            section_of(
                {.EA = 1e6, .GA = 1e6, .GJ = 1e3, .EI = 1e3, .mass = 1, .about_x = 20, .across = 10}))),
        elbow(scene.cable.nodes[std::size_t(leg)]) {
    scene.model.bodies[scene.first()].motion = FixedMotion{};
    add(scene.model, DeadLoad{.body = elbow, .force = {0, 0, 50}, .course = [](double t) {
                                return t < 1 ? t : std::max(0.0, 2 - t);
                              }});
    scene.state = rest_state(scene.model);
    lay(scene.cable, scene.state);
  }
};

struct ElbowRun {
  Worst off{}, change{};  // place [m], energy after the load over its mean [-]
};
ElbowRun push_elbow(int leg, double h) {
  RightAngle beam(leg);
  BeamScene& s = beam.scene;
  const MoreauJean scheme = dynamic_scheme(s.model, h, true);
  ElbowRun out;
  std::vector<double> energies;
  for (const SeriesRow& row : deformable_series("right_angle_cantilever.csv")) {
    const double t = row.at("t_s");
    if (t == 0 || t > 20) continue;
    run_accepted(scheme, s.state, t);
    const Vec3 exact(row.at("elbow_x"), row.at("elbow_y"), row.at("elbow_z"));
    out.off.add((pose(s.state, beam.elbow).p - exact).norm());
    if (t > 2.05) energies.push_back(energy(s.model, s.state).total());
  }
  const double mean = std::accumulate(energies.begin(), energies.end(), 0.0) / double(energies.size());
  for (const double e : energies) out.change.add(std::abs(e - mean) / mean);
  return out;
}

VerificationCase right_angle() {
  return {.name = "E5.right_angle",
          .what =
              "two legs, the elbow pushed out of their plane for 2 s; 20 s with 20 elements a leg and 10 ms, "
              "and with 40 and 5 ms",
          .rows = {{"elbow", "worst place of the elbow with 40 elements", "m", 1e-2, "shared series"},
                   {"order", "order of the two", "-", 1.85, "theory: 2, of two meshes that are not fine yet",
                    Sense::at_least},
                   {"energy", "energy with 20 elements after the load off its mean, relative", "-", 2e-5,
                    "kept but for the order in h"}},
          .measure =
              [] {
                const ElbowRun coarse = push_elbow(20, 1e-2), fine = push_elbow(40, 5e-3);
                return Figures{{"elbow", fine.off},
                               {"order", std::log2(coarse.off / fine.off)},
                               {"energy", coarse.change}};
              },
          .slow = true};
}

// The tip of a cantilever of length 1 under a cross load, beside the curve that does not stretch or shear.
Vec3 elastica_tip(int elements, double load) {
  BeamScene s =
      beam_scene(straight_nodes(Vec3::Zero(), Vec3::UnitX(), elements),
                 {.EA = 1e7, .GA = 1e7, .GJ = 1, .EI = 1, .mass = 1, .about_x = 2e-4, .across = 1e-4}, true);
  const DeadLoad push{.body = s.last(), .force = Vec3::UnitY()};
  add(s.model, push);
  const int steps = std::max(2, int(load / 2));
  for (int k = 1; k <= steps; ++k) {
    *push.factor = load * k / steps;
    settle_accepted(s.model, s.state);
  }
  return pose(s.state, s.last()).p;
}

MeshStudy elasticas() {
  return {
      .name = "E6.elastica",
      .error_of = "tip under the load P L^2 / EI = 5, over the length",
      .unit = "-",
      .counted = "elements",
      .sizes = {4, 8, 16, 32},
      .error = [](int elements) {
        const std::vector<SeriesRow> rows = deformable_series("elastica_cantilever.csv");
        const SeriesRow& row = row_where(rows, "P_L2_over_EI", 5);
        return (elastica_tip(elements, 5) - Vec3(row.at("tip_x_over_L"), row.at("tip_y_over_L"), 0)).norm();
      }};
}

VerificationCase elastica() {
  return {.name = "E6.elastica",
          .what = "cantilever under a cross load at its tip, P L^2 / EI from 0.25 to 10, 32 elements",
          .rows = {{"tip", "worst tip, over the length", "-", 1e-3, "elliptic integrals; shared series"},
                   {"order", "fitted order at the load 5, 4 to 32 elements", "-", 1.9, "theory: 2",
                    Sense::at_least}},
          .measure = [] {
            Worst off;
            for (const SeriesRow& row : deformable_series("elastica_cantilever.csv")) {
              const double load = row.at("P_L2_over_EI");
              if (load > 10) continue;
              const Vec3 exact(row.at("tip_x_over_L"), row.at("tip_y_over_L"), 0);
              off.add((elastica_tip(32, load) - exact).norm());
            }
            return Figures{{"tip", off}, {"order", measured(elasticas()).order}};
          }};
}

// The load at which a clamped column that was compressed evenly loses its stability.
double buckling_load(int elements, double EA, double GA, double from, double to) {
  const auto stable = [&](double load) {
    BeamScene s =
        beam_scene(straight_nodes(Vec3::Zero(), Vec3::UnitX(), elements),
                   {.EA = EA, .GA = GA, .GJ = 1, .EI = 1, .mass = 1, .about_x = 2, .across = 1}, true);
    for (const BodyId node : s.cable.nodes) pose(s.state, node).p.x() *= 1 - load / EA;
    return small_modes(s.model, s.state).omega2[0] > 0;
  };
  for (int k = 0; k < 50; ++k) {
    const double middle = (from + to) / 2;
    (stable(middle) ? from : to) = middle;
  }
  return from;
}

VerificationCase reissner_column() {
  return {.name = "E7.reissner_column",
          .what =
              "clamped column under an axial load, with the stiffnesses along and across of the shared "
              "series, 16 elements",
          .rows = {{"load", "worst load at which the least stiffness vanishes, relative", "-", 1e-3,
                    "Reissner's beam, closed form; shared series"}},
          .measure = [] {
            Worst off;
            for (const SeriesRow& row : deformable_series("reissner_buckling.csv", "clamped-free")) {
              const double exact = row.at("P_L2_over_EI");
              off.add(std::abs(buckling_load(16, row.at("EA_L2_over_EI"), row.at("GA_L2_over_EI"),
                                             0.5 * exact, 1.5 * exact) /
                                   exact -
                               1));
            }
            return Figures{{"load", off}};
          }};
}

// The least singular value of the stiffness of a rod of length 1 that is twisted by a torque and pulled, with
// ends that stay on the x axis and turn about it no more. The torque keeps its direction.
double twisted_stiffness(int elements, double tension, double torque) {
  constexpr double kAlong = 1e6;
  BeamScene s = beam_scene(
      straight_nodes(Vec3::Zero(), Vec3::UnitX(), elements),
      {.EA = kAlong, .GA = 1e6, .GJ = 1, .EI = 1, .mass = 1, .about_x = 2e-4, .across = 1e-4}, false);
  for (int i = 0; i <= elements; ++i) {
    SE3& g = pose(s.state, s.cable.nodes[std::size_t(i)]);
    g.R = (exp_so3(torque * i / elements * Vec3::UnitX()) * g.R).normalized();
    g.p.x() *= 1 + tension / kAlong;
  }
  add(s.model, DeadLoad{.body = s.last(), .moment = torque * Vec3::UnitX()});
  add(s.model, DeadLoad{.body = s.first(), .moment = -torque * Vec3::UnitX()});
  const MatX K(forces_at(s.model, s.state, layout(s.model)).K);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < K.rows(); ++i) {
    const Eigen::Index node = i / 6, d = i % 6;
    const bool held = node == 0 ? d < 4 : node == elements && (d == 1 || d == 2);
    if (!held) free.push_back(i);
  }
  return Eigen::JacobiSVD<MatX>(K(free, free)).singularValues().tail<1>()[0];
}

VerificationCase greenhill() {
  return {
      .name = "E8.greenhill",
      .what = "rod of 32 elements between bearings under a torque, with tensions T L^2 / EI of 0, 10 and 100",
      .rows = {{"torque", "worst torque of the least stiffness, relative", "-", 1e-2,
                "2 sqrt(EI (T + pi^2 EI / L^2)), closed form; shared series"}},
      .measure = [] {
        Worst off;
        for (const SeriesRow& row : deformable_series("twist_buckling.csv", "greenhill_pinned")) {
          const double tension = row.at("T_L2_over_EI_or_ratio"), exact = row.at("M_L_over_EI_or_twist_rad");
          if (tension > 100) continue;  // that curve is shorter than an element
          // The stiffness falls and rises on straight lines: the minimum by thirds
          double from = 0.95 * exact, to = 1.05 * exact;
          for (int k = 0; k < 18; ++k) {
            const double a = from + (to - from) / 3, b = to - (to - from) / 3;
            const bool left = twisted_stiffness(32, tension, a) < twisted_stiffness(32, tension, b);
            (left ? to : from) = left ? b : a;
          }
          off.add(std::abs(from / exact - 1));
        }
        return Figures{{"torque", off}};
      }};
}

// The least stiffness of a rod of length 1, EI = 1, that is straight without stress, bent to a ring, twisted
// and closed; but for that of turning inside out, which is zero.
double ring_stiffness(int elements, double GJ, double twist) {
  constexpr double kRadius = 1 / (2 * kPi), kAlong = 1e6;
  std::vector<SE3> nodes;
  for (int i = 0; i < elements; ++i)
    nodes.push_back(rotation(Vec3::UnitZ(), 2 * kPi * i / elements) * translation(kRadius, 0, 0) *
                    rotation(Vec3::UnitZ(), kPi / 2) * rotation(Vec3::UnitX(), twist * i / elements));
  BeamScene s = beam_scene(
      nodes, {.EA = kAlong, .GA = kAlong, .GJ = GJ, .EI = 1, .mass = 1, .about_x = 2e-4, .across = 1e-4},
      true, {.straight = true});
  BeamElement closing = s.cable.beam.elements[0];
  closing.body_a = s.last(), closing.body_b = s.first();
  closing.frame_b = rotation(Vec3::UnitX(), twist);
  add(s.model, Beam{.name = "closing", .sections = s.cable.beam.sections, .elements = {closing}});
  require_accepted(settle(static_scheme(s.model), s.state, {.displacement = 1e-8}));
  const MatX K(forces_at(s.model, s.state, layout(s.model)).K);
  const VecX all = Eigen::SelfAdjointEigenSolver<MatX>(MatX((K + K.transpose()) / 2), Eigen::EigenvaluesOnly)
                       .eigenvalues();
  return std::abs(all[0]) < 1e-6 ? all[1] : all[0];
}

VerificationCase michell() {
  return {.name = "E8.michell",
          .what = "ring of 32 elements, closed after a twist, with EI / GJ of 1/2, 1 and 3/2",
          .rows = {{"twist", "worst twist at which the least stiffness vanishes, relative", "-", 1e-2,
                    "2 pi sqrt(3) EI / GJ, closed form; shared series"}},
          .measure = [] {
            Worst off;
            for (const SeriesRow& row : deformable_series("twist_buckling.csv", "michell_ring_EI_over_GJ")) {
              const double GJ = 1 / row.at("T_L2_over_EI_or_ratio"),
                           exact = row.at("M_L_over_EI_or_twist_rad");
              const double at97 = ring_stiffness(32, GJ, 0.97 * exact),
                           at99 = ring_stiffness(32, GJ, 0.99 * exact);
              off.add(std::abs(-0.01 + 0.02 * at99 / (at97 - at99)));  // it falls on a straight line
            }
            return Figures{{"twist", off}};
          }};
}

// A beam of 10 m on a hub that is turned up to 6 rad/s within 15 s. (Kane, Ryan and Banerjee 1987) In a step
// of length h nodes go along chords, which adds (omega h)^2 / 8 to the strain: 0.14 % of it with 0.125 ms.
VerificationCase spin_up() {
  return {.name = "E11.spin_up",
          .what =
              "beam of 16 elements on a hub that reaches 6 rad/s in 15 s, one iteration; h = 1 ms to 16 s, "
              "then 0.125 ms",
          .rows = {{"extension", "extension from 16 s to 17 s on average, relative", "-", 1e-2,
                    "rho A omega^2 L^3 / (3 EA), closed form"},
                   {"lag", "largest lag of the tip in that time, over the length", "-", 1e-2,
                    "no instability: the beam is straight"}},
          .measure =
              [] {
                constexpr double kLength = 10, kRise = 15, kSpeed = 6, kStep = 1e-3;
                BeamScene s = beam_scene(straight_nodes(Vec3::Zero(), kLength * Vec3::UnitX(), 16),
                                         {.EA = 2.8e7,
                                          .GA = 1e7,
                                          .GJ = 1.4e4,
                                          .EI = 1.4e4,
                                          .mass = 1.2,
                                          .about_x = 1.2e-3,
                                          .across = 6e-4},
                                         false);
                const auto angle = [](double t) {
                  const double w = 2 * kPi / kRise;
                  return t < kRise ? kSpeed / kRise * (t * t / 2 + (std::cos(w * t) - 1) / (w * w))
                                   : kSpeed * (t - kRise / 2);
                };
                Trajectory path;
                for (int k = 0; k <= 17100; ++k) {
                  path.t.push_back(k * kStep);
                  path.pose.push_back(rotation(Vec3::UnitZ(), angle(k * kStep)) * s.cable.laid[0]);
                }
                s.model.bodies[s.first()].motion = PrescribedMotion{path};
                const MoreauJean scheme = dynamic_scheme(s.model, kStep, false);
                run_accepted(scheme, s.state, 16);
                double sum = 0, count = 0;
                Worst lag;
                run_accepted(dynamic_scheme(s.model, kStep / 8, false), s.state, 17, [&](const StepReport&) {
                  const Vec3 tip = pose(s.state, s.first()).R.conjugate() * pose(s.state, s.last()).p;
                  sum += tip.norm() - kLength, ++count;
                  lag.add(std::hypot(tip.y(), tip.z()) / kLength);
                  return true;
                });
                const double exact = 1.2 * kSpeed * kSpeed * std::pow(kLength, 3) / (3 * 2.8e7);
                return Figures{{"extension", std::abs(sum / count / exact - 1)}, {"lag", lag}};
              },
          .slow = true};
}

VerificationCase helix_at_rest() {
  return {
      .name = "E10.helix_at_rest",
      .what =
          "straight cantilever of 1 m whose rest strain grows to (0, 0, 0, 2, 0, 8), 6 elements, 80 steps",
      .rows = {{"tip", "tip off the helix", "m", 1e-10, "exact: exp of the strain; held exactly"}},
      .measure = [] {
        constexpr int kElements = 6;
        const BeamNumbers numbers{
            .EA = 1e4, .GA = 1e4, .GJ = 100, .EI = 100, .mass = 1, .about_x = 2e-2, .across = 1e-2};
        const std::vector<SE3> nodes = straight_nodes(Vec3::Zero(), Vec3::UnitX(), kElements);
        Vec6 strain;
        strain << 0, 0, 0, 2, 0, 8;
        BeamScene s = beam_scene(nodes, numbers, true);
        const SE3 clamp = pose(s.state, s.first());
        State state = s.state;
        for (int k = 1; k <= 80; ++k) {
          Model model;
          model.gravity = Vec3::Zero();
          Beam beam = s.cable.beam;
          for (BeamElement& e : beam.elements)
            e.rest = straight_rest(e.length) + e.length * (k / 80.0) * strain;
          model.bodies = s.model.bodies;
          add(model, beam);
          settle_accepted(model, state);
        }
        const SE3 exact = clamp * exp_se3(Vec6(Vec6::Unit(0) + strain));
        return Figures{{"tip", (pose(state, s.last()).p - exact.p).norm()}};
      }};
}

// The first two of a cantilever that hardly shears or stretches, of length, mass and EI one [rad/s].
std::array<double, 2> cantilever_frequencies(int elements) {
  const BeamScene s = beam_scene(
      straight_nodes(Vec3::Zero(), Vec3::UnitX(), elements),
      {.EA = 1e7, .GA = 1e7, .GJ = 1e4, .EI = 1, .mass = 1, .about_x = 2e-7, .across = 1e-7}, true);
  const VecX omega = small_modes(s.model, s.state).omega2.cwiseSqrt();  // each in both planes
  return {omega[0], omega[2]};
}

MeshStudy cantilevers() {
  return {
      .name = "E12.frequencies",
      .error_of = "first frequency of a cantilever",
      .unit = "-",
      .counted = "elements",
      .sizes = {8, 16, 32, 64},
      .error = [](int elements) { return std::abs(cantilever_frequencies(elements)[0] / 3.516015269 - 1); }};
}

VerificationCase frequencies() {
  return {.name = "E12.frequencies",
          .what = "small vibrations of a cantilever that hardly shears or stretches, 8 to 64 elements",
          .rows = {{"first", "first with 64 elements off 3.51602, relative", "-", 1e-3,
                    "Euler and Bernoulli, closed form; order two"},
                   {"second", "second with 64 elements off 22.0345, relative", "-", 2e-3,
                    "Euler and Bernoulli, closed form; order two"},
                   {"order", "fitted order of the first, 8 to 64 elements", "-", 1.9, "theory: 2",
                    Sense::at_least}},
          .measure = [] {
            const Convergence first = measured(cantilevers());
            return Figures{{"first", first.error.back()},
                           {"second", std::abs(cantilever_frequencies(64)[1] / 22.03449156 - 1)},
                           {"order", first.order}};
          }};
}

// The modes with two and three waves in the plane of a closed ring that hardly shears or stretches, of
// radius, mass per length and EI one, relative to the exact ones: n (n^2 - 1) / sqrt(n^2 + 1) for n waves.
std::array<double, 2> ring_modes(int elements) {
  std::vector<SE3> nodes;
  for (int i = 0; i < elements; ++i)  // x along the circle
    nodes.push_back(rotation(Vec3::UnitZ(), 2 * kPi * i / elements) * translation(1, 0, 0) *
                    rotation(Vec3::UnitZ(), kPi / 2));
  const BeamScene s = beam_scene(
      nodes, {.EA = 1e6, .GA = 1e6, .GJ = 1e6, .EI = 1, .mass = 1, .about_x = 2e-6, .across = 1e-6}, false,
      {.closed = true});
  const Modes modes = small_modes(s.model, s.state);
  // In the plane: no motion along z. Six motions of the whole ring come first
  std::vector<double> in_plane;
  for (Eigen::Index k = 0; k < modes.omega2.size(); ++k) {
    double out_of = 0, all = 0;
    for (Eigen::Index i = 0; i < modes.shape.rows(); i += 6) {
      out_of += modes.shape(i + 2, k) * modes.shape(i + 2, k);
      all += modes.shape.col(k).segment<3>(i).squaredNorm();
    }
    if (out_of < 1e-6 * all && modes.omega2[k] > 1e-3) in_plane.push_back(std::sqrt(modes.omega2[k]));
  }
  const auto exact = [](double n) { return n * (n * n - 1) / std::sqrt(n * n + 1); };
  return {in_plane.at(0) / exact(2), in_plane.at(2) / exact(3)};
}

MeshStudy rings() {
  return {.name = "E14.ring",
          .error_of = "mode of a closed ring with two waves in its plane",
          .unit = "-",
          .counted = "elements",
          .sizes = {8, 16, 32, 64},
          .error = [](int elements) { return std::abs(ring_modes(elements)[0] - 1); }};
}

VerificationCase closed_ring() {
  return {.name = "E14.ring",
          .what = "a closed ring of 64 elements that hardly shears or stretches",
          .rows = {{"second", "its mode with two waves in the plane, relative", "-", 1e-2,
                    "n (n^2 - 1) / sqrt(n^2 + 1), closed form"},
                   {"third", "its mode with three waves, relative", "-", 1e-2, "the same"}},
          .measure = [] {
            const auto [second, third] = ring_modes(64);
            return Figures{{"second", std::abs(second - 1)}, {"third", std::abs(third - 1)}};
          }};
}

}  // namespace

std::vector<MeshStudy> beam_mesh_studies() {
  return {bends(), elasticas(), cantilevers(), rings()};
}

std::vector<VerificationCase> beam_verification() {
  std::vector<VerificationCase> out;
  for (const int n : {3, 16}) {
    out.push_back(rolled_up("E1.half_circle", kPi, n, {0, 2 / kPi, 0}));
    out.push_back(rolled_up("E1.full_circle", 2 * kPi, n, Vec3::Zero()));
  }
  out.push_back(bend_of_45_degrees());
  out.push_back(flying_beam(true, 5e-3, 2e-5,
                            {{"low_end", "low end at 2.5 s", "m", 5e-3, "shared series of 160 elements"}}));
  out.push_back(flying_beam(false, 2.5e-3, 1e-4, {}));
  out.push_back(flying_spaghetti());
  for (const bool conserving : {false, true}) out.push_back(tumbling_beam(conserving));
  out.push_back(right_angle());
  out.push_back(elastica());
  out.push_back(reissner_column());
  out.push_back(greenhill());
  out.push_back(michell());
  out.push_back(helix_at_rest());
  out.push_back(spin_up());
  out.push_back(frequencies());
  out.push_back(closed_ring());
  return out;
}

}  // namespace aussois
