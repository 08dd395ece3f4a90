// SPDX-License-Identifier: Apache-2.0
#include "nsgs/prox.hpp"

#include <gtest/gtest.h>

#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/planted_problem.hpp"

namespace aussois {
namespace {

TEST(NearestInBall, IsNoFartherInItsMetricThanAnyOtherPoint) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const int rows = 1 + int(seed % 3);
    AnyRows y(rows), s(rows);
    for (int i = 0; i < rows; ++i) {
      y[i] = random.uniform(-2, 2);
      s[i] = random.log_uniform(1e-6, 1);
    }
    const double radius = random.uniform(0, 1.5);
    const AnyRows x = nearest_in_ball(y, s, radius);
    const auto distance = [&](const AnyRows& z) { return (z - y).cwiseAbs2().dot(s); };
    ASSERT_LE(x.norm(), radius * (1 + 1e-15)) << "seed " << seed;
    for (int trial = 0; trial < 2000; ++trial) {  // far, and close to x
      AnyRows z(rows);
      for (int i = 0; i < rows; ++i) z[i] = random.uniform(-1, 1);
      z = trial % 2 == 0 ? AnyRows(radius * z) : AnyRows(x + 1e-3 * radius * z);
      if (z.norm() > radius) z *= radius / z.norm();
      ASSERT_GE(distance(z), distance(x) - 1e-14) << "seed " << seed;
    }
  }
}

TEST(NearestInBall, LeavesWhatIsInside) {
  const AnyRows y = Vec3(0.1, -0.2, 0.3), s = Vec3(1, 1e-3, 5);
  EXPECT_EQ(nearest_in_ball(y, s, 0.5), y);
  EXPECT_EQ(nearest_in_ball(y, s, 0), AnyRows(Vec3::Zero()));
}

TEST(NearestInBall, SlidesAlongTheSoftAxis) {
  // A stiff first axis is kept, the soft one gives way: the limit s_2 / s_1 -> 0 of (SORP-4).
  const AnyRows x = nearest_in_ball(AnyRows(Vec2(0.6, 3)), AnyRows(Vec2(1, 1e-9)), 1);
  EXPECT_NEAR(x[0], 0.6, 1e-7);
  EXPECT_NEAR(x[1], 0.8, 1e-7);
}

TEST(Prox, EndsInTheSameVelocitiesWithAnyMetricAndOrder) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const Planted made = planted(random, random_laws(random, 7), 30);
    for (const Method method : {Method::sor_prox, Method::jor_prox})
      for (const ProxMetric prox : {ProxMetric::blocks, ProxMetric::split, ProxMetric::spectral}) {
        const FrictionSolution s = solve(
            made.problem, {}, {.method = method, .tolerance = 1e-10, .max_iterations = 20000, .prox = prox});
        ASSERT_EQ(s.report.status, SolveStatus::converged)
            << "seed " << seed << " metric " << int(prox) << " residual " << s.report.residual;
        EXPECT_LT((s.u - made.u).norm(), 1e-6 * (1 + made.u.norm())) << "seed " << seed;
      }
  }
}

TEST(Prox, CoulombPgsFindsTheCompliantAnswerOfNsgs) {
  // Two readings of one model: the nonlinear disk row by row, and De Saxce's cone block by block (T-5.3).
  for (unsigned seed = 0; seed < 500; ++seed) {
    Random random(seed);
    Planted made = planted(random, std::vector<Law>(2 + seed % 5, coulomb(random.uniform(0, 0.5))), 6);
    made.problem.R = VecX::Constant(made.problem.w.size(), 1e-2);
    const SolverOptions pgs{.method = Method::coulomb_pgs, .tolerance = 1e-10, .max_iterations = 20000},
        blocks{.method = Method::nsgs, .tolerance = 1e-10, .max_iterations = 20000};
    const FrictionSolution a = solve(made.problem, {}, pgs), b = solve(made.problem, {}, blocks);
    ASSERT_EQ(a.report.status, SolveStatus::converged) << "seed " << seed << " " << a.report.residual;
    ASSERT_EQ(b.report.status, SolveStatus::converged) << "seed " << seed;
    EXPECT_LT((a.r - b.r).norm(), 1e-7 * (1 + b.r.norm())) << "seed " << seed;
  }
}

}  // namespace
}  // namespace aussois
