// SPDX-License-Identifier: Apache-2.0
// Membranes and hinges against differences of their energy, plates against closed forms, and each refusal
// (SHE-1) to (SHE-3).
#include "mechanics/sheet.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/state.hpp"
#include "mechanics/surface.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Mat32 = Eigen::Matrix<double, 3, 2>;

Mat32 random_stretch(Random& random) {
  Mat32 F;
  F.leftCols<2>() = Mat3::Identity().leftCols<2>();
  for (double& x : F.reshaped()) x += random.uniform(-0.3, 0.3);
  return random.pose(1).R.toRotationMatrix() * F;
}

TEST(Membrane, StressAndTangentAreDerivativesOfTheEnergy) {
  Random random(1);
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff})
    for (const double poisson : {0.0, 0.3, 0.45}) {
      const Material m{.law = law, .young = 2, .poisson = poisson, .density = 1};
      for (int trial = 0; trial < 10; ++trial) {
        const Mat32 F = random_stretch(random);
        const MembraneStress at = membrane_stress(m, F);
        for (int k = 0; k < 6; ++k) {
          Mat32 unit = Mat32::Zero();
          unit(k % 3, k / 3) = 1;
          EXPECT_NEAR(slope([&](double d) { return membrane_stress(m, F + d * unit).energy; }), at.P[k],
                      1e-9);
          const Vec6 dP = slope([&](double d) -> Vec6 { return membrane_stress(m, F + d * unit).P; });
          EXPECT_LT((dP - at.A.col(k)).norm(), 1e-8);
        }
      }
    }
}

// In small strain: E / (1 - nu^2) along, nu of it across.
TEST(Membrane, HasTheStiffnessOfPlaneStress) {
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff}) {
    const Material m{.law = law, .young = 3, .poisson = 0.25, .density = 1};
    const Mat32 flat = Mat3::Identity().leftCols<2>();
    const MembraneStress at = membrane_stress(m, flat);
    EXPECT_LT(at.P.norm(), 1e-14);
    EXPECT_NEAR(at.energy, 0, 1e-15);
    EXPECT_NEAR(at.A(0, 0), 3 / (1 - 0.0625), 1e-12);
    EXPECT_NEAR(at.A(0, 4), 0.25 * 3 / (1 - 0.0625), 1e-12);
    EXPECT_NEAR(at.A(1, 1), 1.2, 1e-12);
    EXPECT_NEAR(at.A(2, 2), 0, 1e-12);  // out of its plane
  }
}

// Pulled along one axis alone, a neo-Hookean membrane is the neo-Hookean solid.
TEST(Membrane, IsASolidThatNothingPullsAcross) {
  Random random(2);
  const Material m{.young = 2, .poisson = 0.4, .density = 1};
  for (int trial = 0; trial < 20; ++trial) {
    const Mat32 F = random_stretch(random);
    const Vec3 n = F.col(0).cross(F.col(1)).normalized();
    double across = 1;
    Mat3 whole;
    for (int k = 0; k < 60; ++k) {  // Newton's method on the stretch across
      whole << F, across * n;
      const SolidStress s = whole_stress(m, whole);
      Eigen::Matrix<double, 9, 1> by;
      by << Vec3::Zero(), Vec3::Zero(), n;
      across -= n.dot(s.P.col(2)) / by.dot(s.A * by);
    }
    whole << F, across * n;
    const SolidStress s = whole_stress(m, whole);
    const MembraneStress at = membrane_stress(m, F);
    EXPECT_NEAR(at.energy, s.energy, 1e-13);
    EXPECT_LT((at.P.head<3>() - s.P.col(0)).norm() + (at.P.tail<3>() - s.P.col(1)).norm(), 1e-12);
  }
}

TEST(Hinge, AngleIsThatBetweenTheNormalsWithItsDerivatives) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    std::array<Vec3, 4> x;
    for (Vec3& p : x) p = random.vector(1);
    const HingeAngle at = hinge_angle(x);
    const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized(),
               m = (x[3] - x[0]).cross(x[1] - x[0]).normalized();
    EXPECT_NEAR(std::cos(at.angle), n.dot(m), 1e-12);
    EXPECT_NEAR(std::sin(at.angle), n.cross(m).dot((x[1] - x[0]).normalized()), 1e-12);
    const double size = at.hessian.norm();
    for (int i = 0; i < 12; ++i) {
      const auto moved = [&](double d) {
        std::array<Vec3, 4> y = x;
        y[std::size_t(i) / 3][i % 3] += 1e-2 * d;
        return hinge_angle(y);
      };
      EXPECT_NEAR(slope([&](double d) { return std::remainder(moved(d).angle - at.angle, 2 * kPi); }) / 1e-2,
                  at.gradient[i], 1e-8 * (1 + size * size));
      const Eigen::Matrix<double, 12, 1> by =
          slope([&](double d) -> Eigen::Matrix<double, 12, 1> { return moved(d).gradient; }) / 1e-2;
      EXPECT_LT((by - at.hessian.col(i)).norm(), 1e-7 * (1 + size * size * size));
    }
  }
}

struct SheetScene {
  Model model{};
  State state{};
  Sheet sheet{};
};
SheetScene random_sheet(SolidLaw law, Random& random) {
  SheetScene out;
  std::vector<Vec3> places;
  const SimplicialComplex plate = make_plate(1, 1, 2, 2);
  for (const Vec3& x : plate.vertices) places.push_back(x + random.vector(0.1));
  out.sheet =
      add_sheet(out.model, make_complex(places, plate.triangles),
                {.material = {.law = law, .young = 2, .poisson = 0.3, .density = 3}, .thickness = 0.2});
  out.state = rest_state(out.model);
  for (double& u : out.state.q) u = random.uniform(-0.05, 0.05);
  return out;
}

TEST(Sheet, ForcesAndDerivativesAreThoseOfItsEnergy) {
  Random random(4);
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff}) {
    const SheetScene s = random_sheet(law, random);
    const Forces at = forces_at(s.model, s.state, layout(s.model));
    const MatX K(at.K);
    EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
    for (Eigen::Index i = 0; i < s.state.q.size(); ++i) {
      const auto moved = [&](double d) {
        State state = s.state;
        state.q[i] += d;
        return state;
      };
      EXPECT_NEAR(slope([&](double d) { return energy(s.model, moved(d)).laws; }), -at.laws[i], 1e-8);
      const VecX by =
          slope([&](double d) -> VecX { return forces_at(s.model, moved(d), layout(s.model)).laws; });
      EXPECT_LT((by + K.col(i)).norm(), 1e-7);
    }
  }
}

TEST(Sheet, FeelsNoRigidMotionAndGivesNoMomentumToItself) {
  Random random(5);
  SheetScene s = random_sheet(SolidLaw::neo_hookean, random);
  const double before = energy(s.model, s.state).laws;
  std::vector<Vec3> x = sheet_places(s.model, s.state, s.sheet);
  const VecX force = total_force(s.model, s.state, 0).f;
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 f = force.segment<3>(3 * Eigen::Index(i));
    sum += f, moment += x[i].cross(f);
  }
  EXPECT_LT(sum.norm() + moment.norm(), 1e-13);
  const SE3 g = random.pose(2);
  for (std::size_t i = 0; i < x.size(); ++i)
    s.state.q.segment<3>(3 * Eigen::Index(i)) = g * x[i] - s.sheet.mesh->vertices[i];
  EXPECT_NEAR(energy(s.model, s.state).laws, before, 1e-13);
}

// The energy of a square sheet rolled onto a cylinder along a direction in its plane, over that of a plate.
double rolled_energy(double direction) {
  constexpr double kThick = 1e-3, kRadius = 5;
  Model model;
  const SimplicialComplex plate = make_plate(1, 1, 30, 30);
  const Sheet sheet =
      add_sheet(model, plate, {.material = {.young = 1e9, .poisson = 0, .density = 1}, .thickness = kThick});
  const Vec3 along(std::cos(direction), std::sin(direction), 0), across(-along.y(), along.x(), 0);
  State state = rest_state(model);
  for (std::size_t i = 0; i < plate.vertices.size(); ++i) {
    const Vec3& x = plate.vertices[i];
    const double angle = along.dot(x) / kRadius;
    state.q.segment<3>(3 * Eigen::Index(i)) = kRadius * std::sin(angle) * along + across.dot(x) * across +
                                              kRadius * (1 - std::cos(angle)) * Vec3::UnitZ() - x;
  }
  const double stiffness = 1e9 * std::pow(kThick, 3) / 12;
  return energy(model, state).laws / (stiffness / (2 * kRadius * kRadius));
}

// D kappa^2 / 2 for each unit of area along the edges, and as the pattern of right triangles has it
// elsewhere.
TEST(Sheet, BendsAsAPlateAlongItsEdges) {
  EXPECT_NEAR(rolled_energy(0), 1, 0.05);  // but for a strip at the border
  EXPECT_NEAR(rolled_energy(kPi / 2), 1, 0.05);
  const double one = rolled_energy(kPi / 4), other = rolled_energy(-kPi / 4);
  EXPECT_NEAR(std::min(one, other), 1, 0.05);
  EXPECT_NEAR(std::max(one, other), 3, 0.15);
}

// Pulled along x alone, so that it is in plane stress along y too.
TEST(Sheet, ShowsItsStress) {
  const double pull = 0.1;
  for (const SolidLaw law : {SolidLaw::neo_hookean, SolidLaw::st_venant_kirchhoff}) {
    const Material m{.law = law, .young = 2, .poisson = 0.3, .density = 1};
    Model model;
    const Sheet sheet =
        add_sheet(model, make_plate(1, 1, 3, 3), {.material = m, .thickness = 0.1, .radius = 0.01});
    State state = rest_state(model);
    for (std::size_t i = 0; i < sheet.mesh->vertices.size(); ++i)
      state.q[3 * Eigen::Index(i)] = pull * sheet.mesh->vertices[int(i)].x();
    Mat32 F = Mat32::Zero();
    F(0, 0) = 1 + pull, F(1, 1) = 1;
    const MembraneStress exact = membrane_stress(m, F);
    const double along = exact.P[0], across = exact.P[4] / (1 + pull);  // forces on lengths as deformed
    const double von_mises = std::sqrt(along * along - along * across + across * across);
    const std::vector<double> shown = vertex_field(model, state, sheet.surface);
    EXPECT_EQ(shown.size(), sheet.mesh->vertices.size());
    for (const double stress : shown) EXPECT_NEAR(stress, von_mises, 1e-13);
  }
}

TEST(DeformedShapes, AreMadeAgainOnlyWhereAVertexMoved) {
  Model model;
  const Material m{.young = 2, .poisson = 0.3, .density = 1};
  const Sheet sheet =
      add_sheet(model, make_plate(1, 1, 2, 2), {.material = m, .thickness = 0.1, .radius = 0.01});
  State state = rest_state(model);
  DeformedShapes known;
  const auto there = [&] { return posed_shape(model, state, sheet.surface, &known).own; };
  const auto first = there();
  EXPECT_EQ(there(), first);
  state.q[0] = 1e-17;  // the vertex lies at -1/2
  EXPECT_EQ(there(), first);
  state.q[0] = 1e-3;
  const auto second = there();
  EXPECT_NE(second, first);
  EXPECT_EQ(second->complex.vertices[0].x() - first->complex.vertices[0].x(), -0.499 + 0.5);
  EXPECT_EQ(there(), second);
}

TEST(Sheet, AFieldNeedsANameAndANumberForEachVertex) {
  Model model;
  const Material m{.young = 2, .poisson = 0.3, .density = 1};
  const Sheet sheet =
      add_sheet(model, make_plate(1, 1, 2, 2), {.material = m, .thickness = 0.1, .radius = 0.01});
  const State state = rest_state(model);
  VertexField& field = model.bodies[sheet.surface].deformation.field;
  field.values = [](const Model&, const State&) { return std::vector<double>(3); };
  EXPECT_EQ(message_of([&] { (void)vertex_field(model, state, sheet.surface); }),
            "body 0 (sheet): deformation.field.values: size = 3 must be 9, as of its shape");
  field.what.clear();
  EXPECT_EQ(message_of([&] { validate(model); }),
            "body 0 (sheet): deformation field needs vertices and the name of what it is");
}

TEST(Sheet, HasItsMass) {
  Model model;
  const Sheet sheet =
      add_sheet(model, make_plate(2, 3, 4, 5), {.material = {.young = 1, .density = 7}, .thickness = 0.1});
  double sum = 0;
  for (const PointMass& p : model.coordinates[sheet.points].points) sum += p.mass;
  EXPECT_NEAR(sum, 4.2, 1e-12);
}

TEST(Sheet, RefusesBadInputByName) {
  const SimplicialComplex plate = make_plate(1, 1, 2, 2);
  const SheetOptions good{.material = {.young = 1, .density = 1}, .thickness = 0.1};
  const auto message = [&](const SimplicialComplex& mesh, const SheetOptions& options) {
    Model model;
    return message_of([&] { add_sheet(model, mesh, options); });
  };
  EXPECT_EQ(message(plate, good), "");
  SheetOptions bad = good;
  bad.thickness = 0;
  expect_names(message(plate, bad), "SheetOptions (sheet): thickness = 0 must be positive");
  bad = good, bad.material.viscosity = 1;
  expect_names(message(plate, bad), "material.viscosity = 1 must be 0");
  bad = good, bad.material.young = -1;
  expect_names(message(plate, bad), "material.young = -1 must");
  bad = good, bad.radius = -1;
  expect_names(message(plate, bad), "radius = -1 must");
  bad = good, bad.touches_itself = true;
  expect_names(message(plate, bad), "touches_itself needs a radius");
  bad = good, bad.held = {{true, true, true}};
  expect_names(message(plate, bad), "held.size() = 1 must be 0 or 9");
  expect_names(message(make_segment(1), good), "the mesh must have triangles");
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  expect_names(
      message(make_complex(x, std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}), good),
      "edge 0-1 must have at most two triangles");
  const std::vector<Vec3> four(x.begin(), x.begin() + 4);
  expect_names(message(make_complex(four, std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 1, 3}}), good),
               "edge 0-1: its two triangles must face the same way");
}

}  // namespace
}  // namespace aussois
