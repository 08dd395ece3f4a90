// SPDX-License-Identifier: Apache-2.0
// Laws of materials against differences of their energy, solids against differences of theirs, masses against
// closed forms, and each refusal (FEM-1) to (FEM-8).
#include "mechanics/solid.hpp"

#include <gtest/gtest.h>

#include "geometry/volume_primitives.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/solid_mass.hpp"
#include "mechanics/state.hpp"
#include "mechanics/surface.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

Mat3 random_gradient(Random& random) {
  Mat3 F;
  do {
    F = Mat3::Identity();
    for (double& x : F.reshaped()) x += random.uniform(-0.4, 0.4);
  } while (F.determinant() < 0.2);
  return F;
}

template <class Stress>
void expect_derivatives(const Stress& stress, Random& random) {
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 F = random_gradient(random);
    const SolidStress at = stress(F);
    for (int k = 0; k < 9; ++k) {
      Mat3 unit = Mat3::Zero();
      unit(k % 3, k / 3) = 1;
      EXPECT_NEAR(slope([&](double d) { return stress(F + d * unit).energy; }), at.P(k % 3, k / 3), 1e-7);
      const Mat3 dP = slope([&](double d) -> Mat3 { return stress(F + d * unit).P; });
      EXPECT_LT((dP.reshaped() - at.A.col(k)).norm(), 1e-6) << "trial " << trial << ", entry " << k;
    }
  }
}

TEST(Material, StressAndTangentAreDerivativesOfTheEnergy) {
  Random random(1);
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff}) {
    const Material m{.law = law, .young = 2, .poisson = 0.3, .density = 1};
    expect_derivatives([&](const Mat3& F) { return whole_stress(m, F); }, random);
  }
  const Material m{.young = 2, .poisson = 0.3, .density = 1};
  expect_derivatives([&](const Mat3& F) { return shape_stress(m, F); }, random);
  const VolumeStress at = volume_stress(m, 1.2);
  EXPECT_NEAR(slope([&](double d) { return volume_stress(m, 1.2 + d).energy; }), at.p, 1e-9);
  EXPECT_NEAR(slope([&](double d) { return volume_stress(m, 1.2 + d).p; }), at.by_J, 1e-9);
}

TEST(Material, ShapeFeelsNoChangeOfVolumeAndNothingFeelsATurn) {
  Random random(2);
  const Material m{.young = 2, .poisson = 0.3, .density = 1};
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 F = random_gradient(random), R = random.pose(1).R.toRotationMatrix();
    EXPECT_NEAR(shape_stress(m, 1.3 * F).energy, shape_stress(m, F).energy, 1e-13);
    EXPECT_LT((shape_stress(m, R * F).P - R * shape_stress(m, F).P).norm(), 1e-13);
    EXPECT_LT((whole_stress(m, R * F).P - R * whole_stress(m, F).P).norm(), 1e-13);
  }
}

TEST(Material, HasTheModuliOfSmallStrain) {
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff}) {
    const Material m{.law = law, .young = 3, .poisson = 0.25, .density = 1};
    const Moduli of = moduli(m);
    EXPECT_DOUBLE_EQ(of.shear, 1.2);
    EXPECT_DOUBLE_EQ(of.lame, 1.2);
    const Mat9 A = whole_stress(m, Mat3::Identity()).A;
    EXPECT_NEAR(A(0, 0), of.lame + 2 * of.shear, 1e-12);  // dP_xx / dF_xx
    EXPECT_NEAR(A(0, 4), of.lame, 1e-12);                 // dP_xx / dF_yy
    EXPECT_NEAR(A(1, 1), of.shear, 1e-12);                // dP_yx / dF_yx
  }
}

TEST(Material, VonMisesFeelsNoPressure) {
  const double pressure = -7;
  Mat3 pull = Mat3::Zero(), shear = Mat3::Zero();
  pull(1, 1) = 3;
  shear(0, 2) = shear(2, 0) = 2;
  EXPECT_NEAR(von_mises(pull + pressure * Mat3::Identity()), 3, 1e-14);
  EXPECT_NEAR(von_mises(shear), 2 * std::sqrt(3.0), 1e-14);
}

TEST(Material, ViscousStressResistsStrainAlone) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 F = random_gradient(random), rate = random_gradient(random);
    const ViscousStress at = viscous_stress(0.7, F, rate);
    EXPECT_GE((at.P.array() * rate.array()).sum(), 0);  // takes power
    const Mat3 spin = skew(random.vector(1)) * F;
    EXPECT_LT(viscous_stress(0.7, F, spin).P.norm(), 1e-14);
    for (int k = 0; k < 9; ++k) {
      Mat3 unit = Mat3::Zero();
      unit(k % 3, k / 3) = 1;
      const Mat3 by_F = slope([&](double d) -> Mat3 { return viscous_stress(0.7, F + d * unit, rate).P; });
      const Mat3 by_rate = slope([&](double d) -> Mat3 { return viscous_stress(0.7, F, rate + d * unit).P; });
      EXPECT_LT((by_F.reshaped() - at.by_F.col(k)).norm(), 1e-9);
      EXPECT_LT((by_rate.reshaped() - at.by_rate.col(k)).norm(), 1e-9);
    }
  }
}

struct Cut {
  CellKind cells = CellKind::tets;
  bool smooth_strain = true, mean_volume = true;
};
constexpr Cut kCuts[] = {{CellKind::tets, true, true},   {CellKind::tets, true, false},
                         {CellKind::tets, false, true},  {CellKind::tets, false, false},
                         {CellKind::hexes, false, true}, {CellKind::hexes, false, false}};

struct Scene {
  Model model{};
  State state{};
  Solid solid{};
  std::vector<int> rows() const {  // of State::v
    std::vector<int> out(3 * solid.mesh->points.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = first_speed(model, solid.points) + int(i);
    return out;
  }
  VecX force() const { return VecX(total_force(model, state, 0).f)(rows()); }
};

// Two materials, a body beside it, points anywhere near where they are laid.
Scene random_scene(const Cut& kind, double viscosity, Random& random) {
  VolumeMesh mesh = make_box_mesh({1, 1, 2}, {1, 1, 2}, kind.cells);
  for (Vec3& x : mesh.points) x += random.vector(0.1);
  for (std::size_t c = 0; c < mesh.cells(); ++c) mesh.group_of.push_back(c < mesh.cells() / 2);
  const Material soft{.young = 2, .poisson = 0.3, .density = 1, .viscosity = viscosity},
      stiff{.young = 5, .poisson = 0.2, .density = 2, .viscosity = viscosity};
  Scene out;
  add(out.model, RigidBody{.mass = 1, .inertia = Mat3::Identity()});
  out.solid = add_solid(
      out.model, mesh,
      {.materials = {soft, stiff}, .smooth_strain = kind.smooth_strain, .mean_volume = kind.mean_volume});
  add(out.model, RigidBody{.mass = 1, .inertia = Mat3::Identity()});  // moves the entries of State::v
  out.state = rest_state(out.model);
  for (double& u : out.state.q) u = random.uniform(-0.05, 0.05);
  for (double& v : out.state.v) v = random.uniform(-0.3, 0.3);
  return out;
}

TEST(Solid, ForceIsMinusTheGradientOfItsEnergy) {
  Random random(4);
  for (const Cut& kind : kCuts) {
    const Scene s = random_scene(kind, 0, random);
    const VecX force = s.force();
    for (Eigen::Index i = 0; i < force.size(); ++i)
      EXPECT_NEAR(slope([&](double d) {
                    State moved = s.state;
                    moved.q[i] += d;
                    return energy(s.model, moved).laws;
                  }),
                  -force[i], 1e-8)
          << i;
  }
}

TEST(Solid, DerivativesAreThoseOfItsForce) {
  Random random(5);
  for (const Cut& kind : kCuts)
    for (const double viscosity : {0.0, 0.4}) {
      Scene s = random_scene(kind, viscosity, random);
      add_pressure(s.model, s.solid, boundary_triangles(*s.solid.mesh), [](double) { return 0.3; });
      const Layout dofs = layout(s.model);
      const Forces at = forces_at(s.model, s.state, dofs);
      const MatX K(at.K), C(at.C);
      const Eigen::Index n = s.state.q.size();
      for (Eigen::Index i = 0; i < n; ++i) {
        const VecX by_place = slope([&](double d) -> VecX {
          Scene moved = s;
          moved.state.q[i] += d;
          return moved.force();
        });
        EXPECT_LT((by_place + K.col(dofs.coordinates + i).tail(n)).norm(), 1e-7) << i;
        const VecX by_speed = slope([&](double d) -> VecX {
          Scene moved = s;
          moved.state.v[s.rows()[std::size_t(i)]] += d;
          return moved.force();
        });
        EXPECT_LT((by_speed + C.col(dofs.coordinates + i).tail(n)).norm(), 1e-9) << i;
      }
    }
}

TEST(Solid, FeelsNoRigidMotion) {
  Random random(6);
  for (const Cut& kind : kCuts) {
    Scene s = random_scene(kind, 0, random);
    const VecX force = s.force();
    const std::vector<Vec3> x = solid_places(s.model, s.state, s.solid);
    const SE3 g = random.pose(3);
    const double before = energy(s.model, s.state).laws;
    for (std::size_t i = 0; i < x.size(); ++i)
      s.state.q.segment<3>(3 * Eigen::Index(i)) = g * x[i] - s.solid.mesh->points[i];
    EXPECT_NEAR(energy(s.model, s.state).laws, before, 1e-13);
    const VecX turned = s.force();
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LT((turned.segment<3>(3 * Eigen::Index(i)) - g.R * force.segment<3>(3 * Eigen::Index(i))).norm(),
                1e-12);
  }
}

TEST(Solid, GivesNoMomentumToItself) {
  Random random(7);
  for (const Cut& kind : kCuts) {
    const Scene s = random_scene(kind, 0.4, random);
    const VecX force = s.force();
    const std::vector<Vec3> x = solid_places(s.model, s.state, s.solid);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 f = force.segment<3>(3 * Eigen::Index(i));
      sum += f, moment += x[i].cross(f);
    }
    EXPECT_LT(sum.norm(), 1e-13);
    EXPECT_LT(moment.norm(), 1e-13);
  }
}

TEST(Solid, StressOfAnEvenStrainIsThatOfItsMaterial) {
  Random random(8);
  for (const Cut& kind : kCuts) {
    const Material m{.young = 2, .poisson = 0.3, .density = 1};
    Model model;
    const Solid solid = add_solid(model, make_box_mesh({1, 1, 1}, {2, 2, 2}, kind.cells),
                                  {.materials = {m},
                                   .smooth_strain = kind.smooth_strain,
                                   .mean_volume = kind.mean_volume,
                                   .radius = 0.01});
    State state = rest_state(model);
    const Mat3 F = random_gradient(random);
    for (std::size_t i = 0; i < solid.mesh->points.size(); ++i)
      state.q.segment<3>(3 * Eigen::Index(i)) = (F - Mat3::Identity()) * solid.mesh->points[i];
    const double J = F.determinant();
    const Mat3 exact =
        kind.mean_volume
            ? Mat3(shape_stress(m, F).P * F.transpose() / J + volume_stress(m, J).p * Mat3::Identity())
            : Mat3(whole_stress(m, F).P * F.transpose() / J);
    for (const Mat3& stress : solid_stresses(model, state, solid)) EXPECT_LT((stress - exact).norm(), 1e-12);
    const std::vector<double> at_surface = vertex_field(model, state, solid.surface);
    EXPECT_EQ(at_surface.size(), 26U);
    for (const double stress : at_surface) EXPECT_NEAR(stress, von_mises(exact), 1e-12);
  }
}

TEST(Solid, MassesHaveTheSumAndTheCentreOfTheSolid) {
  Random random(9);
  for (const CellKind cells : {CellKind::tets, CellKind::hexes})
    for (const SolidMass how : {SolidMass::lumped, SolidMass::redistributed}) {
      VolumeMesh mesh = make_box_mesh({2, 1, 1}, {6, 4, 4}, cells);
      for (Vec3& x : mesh.points) x = Vec3(x.x() + 0.3 * x.y() * x.z() + 1, x.y(), x.z());
      const std::vector<double> mass = point_masses(mesh, {{.young = 1, .density = 3}}, how);
      double sum = 0;
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i], moment += mass[i] * mesh.points[i];
      const std::vector<double> lumped = point_masses(mesh, {{.young = 1, .density = 3}}, SolidMass::lumped);
      Vec3 centre = Vec3::Zero();
      for (std::size_t i = 0; i < mass.size(); ++i) centre += lumped[i] * mesh.points[i];
      EXPECT_NEAR(sum, 6, 1e-12);
      EXPECT_LT((moment - centre).norm(), 1e-12);
      long massless = 0;
      const std::vector<int> surface = surface_points(mesh);
      for (const int point : surface) massless += mass[std::size_t(point)] == 0;
      if (how == SolidMass::lumped)
        EXPECT_EQ(massless, 0);
      else if (cells == CellKind::hexes)
        EXPECT_EQ(massless, std::ssize(surface));
      else
        EXPECT_GT(massless, std::ssize(surface) / 2);  // along edges some have no point inside beside them
    }
}

TEST(Solid, ThinPartsKeepTheirMass) {
  const std::vector<double> mass = point_masses(make_box_mesh({1, 1, 1}, {1, 1, 1}),
                                                {{.young = 1, .density = 8}}, SolidMass::redistributed);
  for (const double m : mass) EXPECT_GT(m, 0);
}

TEST(Solid, PressureHasTheResultantOfTheFacesItActsOn) {
  Model model;
  const VolumeMesh mesh = make_box_mesh({1, 2, 3}, {2, 2, 2});
  const Solid solid = add_solid(model, mesh, {.materials = {{.young = 1, .density = 1}}});
  std::vector<std::array<int, 3>> top;
  for (const std::array<int, 3>& t : boundary_triangles(mesh))
    if (std::ranges::all_of(t, [&](int p) { return mesh.points[std::size_t(p)].z() > 1.49; }))
      top.push_back(t);
  add_pressure(model, solid, top, [](double t) { return 5 * t; });
  const VecX f = total_force(model, rest_state(model), 2).f;
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < f.size(); i += 3) sum += f.segment<3>(i);
  EXPECT_LT((sum - Vec3(0, 0, -20)).norm(), 1e-12);
}

TEST(Solid, RefusesBadOptionsByName) {
  const VolumeMesh mesh = make_box_mesh({1, 1, 1}, {1, 1, 1});
  const auto message = [&](const SolidOptions& options) {
    Model model;
    return message_of([&] { add_solid(model, mesh, options); });
  };
  const Material good{.young = 1, .density = 1};
  EXPECT_EQ(message({.materials = {good}}), "");
  expect_names(message({}), "SolidOptions (solid): materials must have one entry");
  expect_names(message({.materials = {{.density = 1}}}), "materials[0].young = 0 must");
  expect_names(message({.materials = {{.young = 1}}}), "materials[0].density = 0 must");
  expect_names(message({.materials = {{.young = 1, .poisson = 0.5, .density = 1}}}), "poisson = 0.5 must");
  expect_names(message({.materials = {{.young = 1, .poisson = 0.49995, .density = 1}}}), "at most 0.4999");
  expect_names(message({.materials = {{.young = 1, .poisson = 0.46, .density = 1}}, .mean_volume = false}),
               "at most 0.45 without mean_volume");
  expect_names(message({.materials = {{.law = SolidLaw::st_venant_kirchhoff, .young = 1, .density = 1}}}),
               "needs mean_volume = false");
  expect_names(message({.materials = {good}, .radius = -1}), "radius = -1 must");
  expect_names(message({.materials = {good}, .held = {{true, true, true}}}),
               "held.size() = 1 must be 0 or 8");
  VolumeMesh grouped = mesh;
  grouped.group_of.assign(grouped.cells(), 1);
  Model model;
  expect_names(message_of([&] { add_solid(model, grouped, {.materials = {good}}); }),
               "group of a cell = 1 must lie in [0, 1)");
}

TEST(Points, HaveMomentumWeightAndEnergyAlongTheAxesOnWhichTheyAreFree) {
  Model model;
  model.gravity = {0, 0, -10};
  Coordinates block{.name = "points", .size = 6};
  block.points = {{.place = {1, 0, 0}, .mass = 2},
                  {.place = {0, 1, 0}, .mass = 3, .held = {false, false, true}}};
  const BlockId id = add(model, block);
  State state = rest_state(model);
  state.q << 0, 0, 1, 0, 0, 5;
  state.v << 0, 2, 0, 1, 0, 7;
  const Energy e = energy(model, state);
  EXPECT_DOUBLE_EQ(e.kinetic, 0.5 * 2 * 4 + 0.5 * 3 * 1);
  EXPECT_DOUBLE_EQ(e.gravity, 20);
  const Momentum p = momentum(model, state);
  EXPECT_EQ(p.linear, Vec3(3, 4, 0));
  EXPECT_EQ(p.angular, Vec3(1, 0, 1).cross(Vec3(0, 4, 0)) + Vec3(0, 1, 5).cross(Vec3(3, 0, 0)));
  EXPECT_EQ(block_weight(model, id), (VecX(6) << 0, 0, -20, 0, 0, 0).finished());
}

TEST(Points, AreRefusedByName) {
  Model model;
  const auto message = [&](const Coordinates& block) { return message_of([&] { add(model, block); }); };
  expect_names(message({.name = "p", .size = 4, .points = {{.mass = 1}}}), "size = 4 must be 3");
  expect_names(message({.name = "p", .size = 3, .points = {{.mass = -1}}}), "point 0: mass = -1 must");
  Coordinates both{.name = "p", .size = 3, .points = {{.mass = 1}}};
  both.mass = [](const VecX&) { return MatX::Identity(3, 3); };
  expect_names(message(both), "mass, force and potential must be empty");
}

}  // namespace
}  // namespace aussois
