// SPDX-License-Identifier: Apache-2.0
#include "nsgs/anderson.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/planted_problem.hpp"

namespace aussois {
namespace {

TEST(Anderson, SolvesALinearFixedPointInAsManyStepsAsItHasUnknowns) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const int n = 2 + int(seed % 6);
    const MatX A = MatX::NullaryExpr(n, n, [&] { return random.uniform(-1, 1); });  // not even a contraction
    const VecX b = VecX::NullaryExpr(n, [&] { return random.uniform(-1, 1); });
    const VecX fixed = (MatX::Identity(n, n) - A).partialPivLu().solve(b);
    Anderson anderson(n);
    VecX x = VecX::Zero(n);
    for (int step = 0; step <= n; ++step) {
      const VecX g = A * x + b, proposed = anderson.propose(x, g);
      x = proposed.size() > 0 ? proposed : g;
    }
    // The Gram matrix squares the condition of the steps.
    EXPECT_LT((x - fixed).norm(), 1e-5 * (1 + fixed.norm())) << "seed " << seed;
  }
}

TEST(Anderson, WithoutMemoryProposesNothing) {
  Anderson anderson(0);
  for (int step = 0; step < 3; ++step)
    EXPECT_EQ(anderson.propose(VecX::Constant(2, step), VecX::Ones(2)).size(), 0);
}

TEST(Anderson, ForgetsTheStepsBefore) {
  Anderson anderson(2);
  anderson.propose(VecX::Zero(2), VecX::Ones(2));
  anderson.forget();
  EXPECT_EQ(anderson.propose(VecX::Ones(2), VecX::Zero(2)).size(), 0);
}

TEST(Anderson, SavesSweepsWhereTheyContractSlowly) {
  long plain_sweeps = 0, accelerated_sweeps = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const Planted made = planted(random, random_laws(random, 14), 15);  // hyperstatic
    for (const Method method : {Method::nsgs, Method::sor_prox, Method::jor_prox}) {
      const SolverOptions plain{.method = method, .tolerance = 1e-8, .max_iterations = 3000},
          accelerated{.method = method, .tolerance = 1e-8, .max_iterations = 3000, .anderson = 5};
      plain_sweeps += solve(made.problem, {}, plain).report.iterations;
      const SolveReport report = solve(made.problem, {}, accelerated).report;
      accelerated_sweeps += report.iterations;
    }
  }
  EXPECT_LT(accelerated_sweeps, plain_sweeps / 2);
}

}  // namespace
}  // namespace aussois
