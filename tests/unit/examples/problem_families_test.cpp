// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/families/problem_families.hpp"

#include <numeric>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const SceneBody& body(const FrictionScene& scene, int index) {
  return scene.bodies[index];
}

double weight(const FrictionScene& scene) {
  return std::accumulate(scene.bodies.begin(), scene.bodies.end(), 0.0,
                         [](double sum, const SceneBody& b) { return sum + b.mass; }) *
         9.81;
}

/// What one step of gravity does to a vault at rest: the largest speed [m/s], relative to free fall.
double fall(const Vault& spec) {
  const FrictionScene scene = vault(spec);
  const FrictionSolution s = solve(friction_problem(scene), {}, {.tolerance = 1e-10});
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  return s.v.cwiseAbs().maxCoeff() / (9.81 * scene.h);
}

}  // namespace

TEST(ProblemFamilies, AreNamedAndRefuseOthers) {
  EXPECT_EQ(problem_families().size(), 12u);
  for (const ProblemFamily& family : problem_families())
    EXPECT_EQ(family_named(family.name).scene, family.scene);
  EXPECT_EQ(message_of([] { family_named("heap"); }).substr(0, 50),
            "family 'heap' must be one of box_stack, kapla_towe");
  EXPECT_EQ(message_of([] { family_scene(problem_families()[0], 0, 1); }),
            "contacts = 0 must lie in [1, 1000000]");
}

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest calls it so
void PrintTo(const ProblemFamily& family, std::ostream* out) {
  *out << family.name;
}

class Families : public ::testing::TestWithParam<ProblemFamily> {};

TEST_P(Families, HaveAboutAsManyContactsAsAsked) {
  for (const int size : {10, 30, 100, 300, 1000})
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const double count = double(family_scene(GetParam(), size, seed).contacts.size());
      EXPECT_GE(count, 0.6 * size) << size << " seed " << seed;
      EXPECT_LE(count, 1.4 * size + 22) << size << " seed " << seed;  // the least chain and bridge have 32
    }
}

TEST_P(Families, AreTheSameBytesForTheSameSeed) {
  const std::filesystem::path folder = fresh_folder();
  const auto bytes = [&](const char* name, std::uint64_t seed) {
    write_fclib(folder / name, family_file(GetParam(), 40, seed));
    return content_of(folder / name);
  };
  const std::string first = bytes("a.hdf5", 1);
  EXPECT_EQ(first, bytes("b.hdf5", 1));
  EXPECT_NE(first, bytes("c.hdf5", 2));
}

TEST_P(Families, HavePositiveDefiniteMass) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const FrictionProblem problem = friction_problem(family_scene(GetParam(), 60, seed));
    const SparseMatrix transposed = problem.M.transpose();
    const Eigen::SimplicialLLT<SparseMatrix> factor(SparseMatrix(problem.M + transposed));
    EXPECT_EQ(factor.info(), Eigen::Success) << "seed " << seed;
    const bool symmetric = SparseMatrix(problem.M - transposed).norm() <= 1e-15 * problem.M.norm();
    EXPECT_EQ(symmetric, std::string(GetParam().name) != "gyroscopic") << "seed " << seed;
  }
}

// A rigid motion of all bodies is none between two of them, and its own velocity field against what is fixed.
TEST_P(Families, SeeNoMotionInARigidOne) {
  Random random(5);
  const FrictionScene scene = family_scene(GetParam(), 60, 1);
  const FrictionProblem problem = friction_problem(scene);
  const Vec3 speed = random.vector(), omega = random.vector();
  const auto field = [&](const Vec3& x) -> Vec3 { return speed + omega.cross(x); };
  VecX v(problem.f.size());
  Eigen::Index next = 0;
  for (const SceneBody& b : scene.bodies) {
    if (b.mass == 0) continue;
    v.segment<6>(next) << field(b.centre), omega;
    next += 6;
  }
  ASSERT_EQ(next, v.size());
  const auto check = [&](const std::vector<Interaction>& interactions, const VecX& seen) {
    Eigen::Index row = 0;
    for (const Interaction& at : interactions)
      for (const Vec6& direction : at.rows) {
        const double against = double(body(scene, at.a).mass > 0) - double(body(scene, at.b).mass > 0);
        const double expected =
            against * (direction.head<3>().dot(field(at.point)) + direction.tail<3>().dot(omega));
        EXPECT_NEAR(seen[row++], expected, 1e-12 * (1 + at.point.norm()));
      }
    EXPECT_EQ(row, seen.size());
  };
  check(scene.contacts, problem.H.transpose() * v);
  if (!scene.joints.empty()) check(scene.joints, problem.G.transpose() * v);
}

TEST_P(Families, HaveUnitNormalsFromOneBodyToTheOther) {
  const FrictionScene scene = family_scene(GetParam(), 60, 2);
  for (const Interaction& at : scene.contacts) {
    ASSERT_NE(at.a, at.b);
    EXPECT_TRUE(body(scene, at.a).mass > 0 || body(scene, at.b).mass > 0);
    EXPECT_GE(at.gap, 0);
    EXPECT_EQ(int(at.rows.size()), at.law.rows);
    for (const Vec6& row : at.rows) EXPECT_NEAR(row.norm(), 1, 1e-12);
  }
}

TEST_P(Families, AreSolvedByTheAutomaticSolver) {
  for (const int size : {10, 40})
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const FrictionProblem problem = friction_problem(family_scene(GetParam(), size, seed));
      const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-8});
      EXPECT_EQ(s.report.status, SolveStatus::converged) << size << " seed " << seed;
      EXPECT_LE(scaled_residual(condense(problem), s.r), 1.01e-8) << size << " seed " << seed;
    }
}

// The way to the answer is the same, and ends sooner.
TEST_P(Families, AskNoMoreWorkForLessAccuracy) {
  for (const int size : {40, 300})
    for (const std::uint64_t seed : {1u, 2u}) {
      const FrictionProblem problem = friction_problem(family_scene(GetParam(), size, seed));
      SolveReport finer{.iterations = 1 << 30, .newton_iterations = 1 << 30};
      for (const double tolerance : {1e-10, 1e-8, 1e-6}) {
        const SolveReport now = solve(problem, {}, {.tolerance = tolerance}).report;
        EXPECT_LE(now.iterations, finer.iterations) << size << " seed " << seed << " to " << tolerance;
        EXPECT_LE(now.newton_iterations, finer.newton_iterations)
            << size << " seed " << seed << " to " << tolerance;
        finer = now;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Families,
                         ::testing::ValuesIn(problem_families().begin(), problem_families().end()),
                         [](const auto& family) { return std::string(family.param.name); });

TEST(BoxStack, StandsOnTheGroundWithItsWholeWeight) {
  Random random(1);
  for (const double play : {0.0, 1e-4}) {  // to 1e-10 of q = h g, times the square root of the rows
    const FrictionScene scene = cube_grid(2, 3, play, coulomb(0.5), random);
    EXPECT_EQ(scene.contacts.size(), 3u * (16 + 16));
    const FrictionSolution s = solve(friction_problem(scene), {}, {.tolerance = 1e-10});
    ASSERT_EQ(s.report.status, SolveStatus::converged);
    double carried = 0;
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (scene.contacts[c].b == 0) carried += s.r[Eigen::Index(3 * c)];
    EXPECT_NEAR(carried, weight(scene) * scene.h, 1e-8 * weight(scene) * scene.h);
    EXPECT_LT(s.v.cwiseAbs().maxCoeff(), 1e-7 * 9.81 * scene.h);
  }
}

// The least thickness of a half circle is 0.1075 of its mean radius, and friction must reach about 0.3.
TEST(Arch, StandsIfItIsThickAndRoughEnough) {
  EXPECT_LT(fall({.voussoirs = 40, .thickness = 0.115, .mu = 0.8}), 1e-6);
  EXPECT_GT(fall({.voussoirs = 40, .thickness = 0.100, .mu = 0.8}), 1e-3);
  EXPECT_LT(fall({.voussoirs = 20, .thickness = 0.15, .mu = 0.6}), 1e-6);
  EXPECT_GT(fall({.voussoirs = 20, .thickness = 0.15, .mu = 0.2}), 1e-3);
}

TEST(Arch, OfManyCoursesStandsAsOne) {
  EXPECT_LT(fall({.voussoirs = 12, .courses = 3, .thickness = 0.15, .mu = 0.6}), 1e-6);
  EXPECT_EQ(vault({.voussoirs = 12, .courses = 3}).contacts.size(), std::size_t(4 * 13 * 3 + 4 * 12 * 2));
}

TEST(Chain, HasFourTimesAsManyRowsAsItsLinksHaveMotions) {
  Random random(1);
  const FrictionScene scene = chain(100, random);
  const Eigen::Index motions = 6 * (Eigen::Index(scene.bodies.size()) - 1);
  const FrictionProblem problem = friction_problem(scene);
  EXPECT_GE(problem.H.cols(), 4 * motions);
  EXPECT_EQ(MatX(problem.H).colPivHouseholderQr().rank(), motions);
}

TEST(RedundantJoints, LeaveATableOneMotionOutOfThirty) {
  Random random(1);
  const FrictionProblem problem = friction_problem(redundant_joints(24, random));
  ASSERT_EQ(problem.G.cols(), 2 * 2 * 4 * 5);  // hinges of four cranks, doubled
  EXPECT_EQ(MatX(problem.G).colPivHouseholderQr().rank(), 29);
}

TEST(SpherePile, IsSettledWithoutOverlap) {
  Random random(1);
  const FrictionScene scene = sphere_pile(300, random);
  std::vector<int> touching(scene.bodies.size());
  for (const Interaction& at : scene.contacts) {
    ++touching[at.a];
    ++touching[at.b];
    for (const int index : {at.a, at.b}) {
      if (index == 0) continue;
      const SceneBody& ball = body(scene, index);
      const double radius = std::sqrt(2.5 * ball.inertia(0, 0) / ball.mass);
      EXPECT_NEAR((at.point - ball.centre).norm(), radius, 0.02 * 0.014);  // 2e-4 is the largest gap
    }
  }
  int rattlers = 0;
  for (std::size_t i = 1; i < touching.size(); ++i) rattlers += touching[i] < 3;
  EXPECT_LT(rattlers, int(touching.size()) / 10);
}

TEST(MassRatio, SpansTwoToSixDecades) {
  double smallest = kInf, largest = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    double least = kInf, most = 0;
    for (const SceneBody& b : family_scene(family_named("mass_ratio"), 300, seed).bodies)
      if (b.mass > 0) least = std::min(least, b.mass), most = std::max(most, b.mass);
    smallest = std::min(smallest, most / least);
    largest = std::max(largest, most / least);
  }
  EXPECT_LT(smallest, 1e3);  // drawn evenly on the logarithm, the slab a few times its cubes
  EXPECT_GT(smallest, 1e2);
  EXPECT_GT(largest, 3e5);
}

TEST(MixedLaws, HaveEveryKind) {
  Random random(1);
  std::vector<int> counts(6);
  for (const Interaction& at : mixed_laws(100, random).contacts) ++counts[std::size_t(at.law.kind)];
  for (const int count : counts) EXPECT_GT(count, 0);
}

TEST(Impacts, RequireSomeContactsToPart) {
  Random random(1);
  const FrictionScene scene = impacts(200, random);
  const VecX w = friction_problem(scene).w;
  EXPECT_GT((w.array() < 0).count(), int(scene.contacts.size()) / 5);
  EXPECT_EQ((w.array() > 0).count(), 0);
}

}  // namespace aussois
