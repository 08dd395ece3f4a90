// SPDX-License-Identifier: Apache-2.0
// Group F: solids under finite strain (doc/theory/solids.md).
#include <cmath>
#include <random>

#include <Eigen/LU>

#include "examples/scenes/soft_parts.hpp"
#include "examples/studies/verification/mesh_study.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/so3.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

// Steps of theta = 1 that end in an equilibrium; places are of the size of `length`.
void settle_accepted(SolidScene& s, double length) {
  const MoreauJean scheme(s.model, {.h = 1e6}, {.theta = 1});
  require_accepted(settle(scheme, s.state, {.growth = 10, .displacement = 1e-10 * length}));
}

// How a solid is cut and what is averaged.
struct Kind {
  std::string name{};
  CellKind cells = CellKind::tets;
  bool smooth_strain = true, mean_volume = true;
};
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{{"tetrahedra, smoothed", CellKind::tets, true, true},
                                     {"tetrahedra, smoothed strain", CellKind::tets, true, false},
                                     {"tetrahedra", CellKind::tets, false, false},
                                     {"hexahedra, mean volume", CellKind::hexes, false, true},
                                     {"hexahedra", CellKind::hexes, false, false}};
  return all;
}
SolidOptions options_of(const Kind& kind, const Material& material) {
  return {.materials = {material}, .smooth_strain = kind.smooth_strain, .mean_volume = kind.mean_volume};
}

VerificationCase patch(const Kind& kind) {
  return {.name = "F1.patch",
          .setting = kind.name,
          .what =
              "a box of 3 x 3 x 3 cells, its inner points moved by up to a tenth of a cell, strained evenly "
              "by up to 40 % and turned",
          .rows = {{"force", "largest force on an inner point, over the largest on the outside", "-", 1e-12,
                    "exact: even strain is in equilibrium"}},
          .measure = [=] {
            VolumeMesh mesh = make_box_mesh(Vec3::Ones(), {3, 3, 3}, kind.cells);
            const auto inside = [](const Vec3& x) { return x.cwiseAbs().maxCoeff() < 0.49; };
            std::mt19937 random(1);
            std::uniform_real_distribution<double> part(-1.0 / 30, 1.0 / 30);
            const std::vector<int> inner = points_where(mesh, inside);
            for (const int p : inner)
              mesh.points[std::size_t(p)] += Vec3(part(random), part(random), part(random));
            SolidScene s = solid_scene(mesh, options_of(kind, {.young = 1, .poisson = 0.3, .density = 1}));
            Mat3 F;
            F << 1.4, 0.2, -0.1, 0.1, 0.8, 0.3, -0.2, 0.1, 1.1;
            F = exp_so3(Vec3(1, 2, -1)).toRotationMatrix() * F;
            place(s, [&](const Vec3& x) -> Vec3 { return F * x + Vec3(3, -1, 2); });
            const std::vector<Vec3> force = point_forces(s);
            Worst most, within;
            for (const Vec3& f : force) most.add(f.norm());
            for (const int p : inner) within.add(force[std::size_t(p)].norm());
            return Figures{{"force", within / most}};
          }};
}

// What Cook's membrane rises by under a load of 100 on a thickness of 1. A small part of it, since the shared
// series is linear.
double cook(int side, const Kind& kind) {
  constexpr double kPart = 1e-5, kLoad = 100;
  CookMembrane s(side, kind.cells, options_of(kind, {.young = 250, .poisson = 0.4999, .density = 1}),
                 kPart * kLoad * 48 / side, 1);
  const MoreauJean scheme(s.scene.model, {.h = 1e6}, {.theta = 1});
  require_accepted(settle(scheme, s.scene.state, {.first_h = 1e6, .displacement = 1e-12}));
  return s.rise() / kPart;
}

VerificationCase cook_membrane() {
  return {.name = "F2.cook",
          .what =
              "Cook's membrane in plane strain, nearly incompressible, hexahedra, 16 a side, and smoothed "
              "tetrahedra, 32 cells a side",
          .rows = {{"hexahedra", "rise of the middle of its right side", "mm", 7.2,
                    "shared series of quadratic elements, 7.37 in the limit", Sense::at_least},
                   {"tetrahedra", "the same", "mm", 7.2, "shared series", Sense::at_least},
                   {"highest", "the higher of both", "mm", 7.38, "shared series; elements from below"}},
          .measure = [] {
            const double hexahedra = cook(16, kinds()[3]), tetrahedra = cook(32, kinds()[0]);
            return Figures{{"hexahedra", hexahedra},
                           {"tetrahedra", tetrahedra},
                           {"highest", std::max(hexahedra, tetrahedra)}};
          }};
}

// A cantilever of length 1 and a square section of 0.1 under a cross load on its end.
Vec3 solid_elastica(int through, double load) {
  constexpr double kThick = 0.1, kYoung = 1e6;
  const VolumeMesh mesh = [&] {
    VolumeMesh box = make_box_mesh({1, kThick, kThick}, {10 * through, through, through});
    for (Vec3& x : box.points) x.x() += 0.5;
    return box;
  }();
  SolidOptions options{.materials = {{.young = kYoung, .poisson = 0.3, .density = 1}}, .mean_volume = false};
  hold(mesh, options, {true, true, true}, [](const Vec3& x) { return x.x() < 1e-9; });
  SolidScene s = solid_scene(mesh, options);
  const double EI = kYoung * std::pow(kThick, 4) / 12;
  const auto end = [](const Vec3& x) { return x.x() > 1 - 1e-9; };
  const FaceLoad push{.force = EI * Vec3::UnitY(), .is_there = end};
  add(s.model, s.solid, push);
  for (int k = 1; k <= 4; ++k) {
    *push.factor = load * k / 4;
    settle_accepted(s, 1);
  }
  const std::vector<Vec3> x = solid_places(s.model, s.state, s.solid);
  Vec3 sum = Vec3::Zero();
  const std::vector<int> points = points_where(
      mesh, [&](const Vec3& at) { return end(at) && std::abs(std::abs(at.y()) - kThick / 2) < 1e-9; });
  for (const int p : points) sum += x[std::size_t(p)];
  return sum / double(points.size());
}

VerificationCase elastica_by_solids() {
  return {.name = "F6.elastica",
          .what =
              "cantilever of 1 m x 0.1 m x 0.1 m under a cross load at its end, P L^2 / EI = 2, 4 smoothed "
              "cells through its thickness",
          .rows = {{"tip", "middle of its end, over the length", "-", 1e-2,
                    "elliptic integrals of a thin one, which does not shear; shared series"}},
          .measure =
              [] {
                const std::vector<SeriesRow> rows = deformable_series("elastica_cantilever.csv");
                const SeriesRow& row = row_where(rows, "P_L2_over_EI", 2);
                const Vec3 exact(row.at("tip_x_over_L"), row.at("tip_y_over_L"), 0);
                return Figures{{"tip", (solid_elastica(4, 2) - exact).norm()}};
              },
          .slow = true};
}

// A cube of one cell, pulled along x between rollers.
VerificationCase uniaxial(const Kind& kind) {
  return {.name = "F7.uniaxial",
          .setting = kind.name,
          .what = "one cell pulled to between half and three times its length, sides free",
          .rows = {{"stress", "worst nominal stress, over the shear modulus", "-", 1e-10,
                    "roots of the law; shared series"},
                   {"side", "worst stretch across", "-", 1e-10, "roots of the law; shared series"}},
          .measure = [=] {
            Worst stress, side;
            for (const SeriesRow& row : deformable_series("neo_hookean_uniaxial.csv")) {
              const double nu = row.at("nu"), stretch = row.at("stretch");
              if (nu > 0.45) continue;
              VolumeMesh mesh = make_box_mesh(Vec3::Ones(), {1, 1, 1}, kind.cells);
              for (Vec3& x : mesh.points) x += Vec3::Constant(0.5);
              const Material material{.young = 2 * (1 + nu), .poisson = nu, .density = 1};  // shear modulus 1
              SolidOptions options = options_of(kind, material);
              for (int d = 0; d < 3; ++d)
                hold(mesh, options, {d == 0, d == 1, d == 2}, [=](const Vec3& x) { return x[d] < 1e-9; });
              hold(mesh, options, {true, false, false}, [](const Vec3& x) { return x.x() > 1 - 1e-9; });
              SolidScene s = solid_scene(mesh, options);
              const double across = std::pow(stretch, -nu);  // close
              place(s, [&](const Vec3& x) -> Vec3 { return x.cwiseProduct(Vec3(stretch, across, across)); });
              settle_accepted(s, 1e-2);
              double pull = 0;
              const std::vector<Vec3> force = point_forces(s), x = solid_places(s.model, s.state, s.solid);
              for (std::size_t p = 0; p < mesh.points.size(); ++p) {
                if (mesh.points[p].x() > 0.5) pull -= force[p].x();
                for (int d = 1; d < 3; ++d)
                  if (mesh.points[p][d] > 0.5) side.add(std::abs(x[p][d] - row.at("lateral_stretch")));
              }
              stress.add(std::abs(pull - row.at("nominal_stress_over_mu")));
            }
            return Figures{{"stress", stress}, {"side", side}};
          }};
}

// An eighth of a thick hollow ball, radii 1 and 2, whose inside is held at a stretch.
double inflating_pressure(const Kind& kind, const Material& material, int through, double stretch) {
  const VolumeMesh mesh = make_shell_octant_mesh(1, 2, through, through, kind.cells);
  SolidOptions options = options_of(kind, material);
  for (int d = 0; d < 3; ++d)
    hold(mesh, options, {d == 0, d == 1, d == 2}, [=](const Vec3& x) { return std::abs(x[d]) < 1e-9; });
  const auto inside = [](const Vec3& x) { return x.norm() < 1 + 1e-9; };
  hold(mesh, options, {true, true, true}, inside);
  SolidScene s = solid_scene(mesh, options);
  const int steps = int(std::round((stretch - 1) / 0.025));
  for (int k = 1; k <= steps; ++k) {  // from the last one without a change of volume
    const auto cube = [&](int step) { return std::pow(1 + (stretch - 1) * step / steps, 3); };
    const std::vector<Vec3> x = solid_places(s.model, s.state, s.solid);
    for (std::size_t p = 0; p < x.size(); ++p) {
      const double r = x[p].norm(), grown = std::cbrt(r * r * r + cube(k) - cube(k - 1));
      s.state.q.segment<3>(3 * Eigen::Index(p)) = grown / r * x[p] - mesh.points[p];
    }
    const MoreauJean scheme(s.model, {.h = 1e6}, {.theta = 1});
    require_accepted(settle(scheme, s.state, {.first_h = 1e6, .displacement = 1e-9}));
  }
  const std::vector<Vec3> force = point_forces(s);
  double push = 0;
  for (const int p : points_where(mesh, inside))
    push -= force[std::size_t(p)].dot(mesh.points[std::size_t(p)].normalized());
  return push / (kPi / 2 * stretch * stretch);
}

struct HollowBall {
  std::string setting{};
  Kind kind{};
  Material material{};  // shear modulus 1
  std::string ratio{};  // of Lame's constants, as in the shared series
  bool of_order = false;
};
std::vector<HollowBall> hollow_balls() {
  const double nu = 0.4999;
  const Material equal{.young = 2.5, .poisson = 0.25, .density = 1},
      rubber{.young = 2 * (1 + nu), .poisson = nu, .density = 1};
  return {{"tetrahedra, Lame's constants equal", kinds()[1], equal, "1", false},
          {"hexahedra, Lame's constants equal", kinds()[4], equal, "1", true},
          {"hexahedra, nearly incompressible", kinds()[3], rubber, "inf", true}};
}

double inflating_error(const HollowBall& ball, const SeriesRow& row, int through) {
  return std::abs(inflating_pressure(ball.kind, ball.material, through, row.at("inner_stretch")) /
                      row.at("pressure_over_mu") -
                  1);
}

MeshStudy inflations(const HollowBall& ball) {
  return {.name = "F8.hollow_ball",
          .setting = ball.setting,
          .error_of = "pressure at the inner stretch 1.25",
          .unit = "-",
          .counted = "cells through the wall",
          .sizes = {3, 4, 5, 6},
          .error = [ball](int through) {
            const std::vector<SeriesRow> rows = deformable_series("neo_hookean_sphere.csv", ball.ratio);
            return inflating_error(ball, row_where(rows, "inner_stretch", 1.25), through);
          }};
}

VerificationCase hollow_ball(const HollowBall& ball) {
  VerificationCase out{
      .name = "F8.hollow_ball",
      .setting = ball.setting,
      .what = "thick hollow ball blown up to inner stretches of 1.05 to 1.5, 4 cells through its wall",
      .rows = {{"pressure", "worst pressure, relative", "-", 2e-2, "shared series: shooting, closed form"}},
      .measure =
          [ball] {
            Worst off;
            for (const SeriesRow& row : deformable_series("neo_hookean_sphere.csv", ball.ratio))
              if (row.at("inner_stretch") <= 1.5) off.add(inflating_error(ball, row, 4));
            Figures figures{{"pressure", off}};
            if (ball.of_order) figures["order"] = measured(inflations(ball)).order;
            return figures;
          },
      .slow = true};
  if (ball.of_order)
    out.rows.push_back(
        {"order", "fitted order at the stretch 1.25, 3 to 6 cells", "-", 1.8, "theory: 2", Sense::at_least});
  return out;
}

}  // namespace

std::vector<MeshStudy> solid_mesh_studies() {
  std::vector<MeshStudy> out;
  for (const HollowBall& ball : hollow_balls())
    if (ball.of_order) out.push_back(inflations(ball));
  return out;
}

std::vector<VerificationCase> solid_verification() {
  std::vector<VerificationCase> out;
  for (const Kind& kind : kinds()) out.push_back(patch(kind));
  out.push_back(cook_membrane());
  out.push_back(elastica_by_solids());
  for (const Kind& kind : kinds())
    if (!kind.mean_volume) out.push_back(uniaxial(kind));
  for (const HollowBall& ball : hollow_balls()) out.push_back(hollow_ball(ball));
  return out;
}

}  // namespace aussois
