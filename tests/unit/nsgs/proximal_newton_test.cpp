// SPDX-License-Identifier: Apache-2.0
#include "nsgs/proximal_newton.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "nsgs/residual.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

TEST(ProximalNewton, SolvesTheCompliantProblem) {
  // From r = 0 a step solves the problem with alpha on the diagonal of the scaled W: solved by sweeps to
  // compare.
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 10, 0.2);
    const LocalProblem local = condense(problem);
    const double alpha = 0.1;
    LocalProblem compliant = local;
    const VecX w = row_scales(local.W.diagonal(), local.laws);
    compliant.W += SparseMatrix((alpha * w).asDiagonal());
    const FrictionSolution reference = solve(compliant, {}, {.method = Method::nsgs, .tolerance = 1e-12});
    ASSERT_EQ(reference.report.status, SolveStatus::converged) << "seed " << seed;
    const auto inverse = invert_mass(problem.M);
    const auto bodies = make_delassus(problem, *inverse), contacts = make_delassus(local);
    for (Delassus* W : {bodies.get(), contacts.get()}) {
      NewtonSolve newton;
      const ProximalStep step =
          proximal_step(*W, judged(*W, VecX::Zero(30), Method::automatic), alpha, 1e-9, newton);
      EXPECT_TRUE(step.solved) << "seed " << seed;
      const VecX r = W->scaled.size * W->scaled.s.cwiseProduct(step.r);
      EXPECT_LE((r - reference.r).norm(), 1e-8 * reference.r.norm()) << "seed " << seed;
    }
  }
}

TEST(ProximalNewton, LeavesASolutionWhereItIs) {
  Random random(3);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 20, 0.2);
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-13});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  const auto inverse = invert_mass(problem.M);
  const auto W = make_delassus(problem, *inverse);
  const Iterate solution = judged(*W, scaled_start(W->scaled, s.r), Method::automatic);
  for (const double alpha : {1e-3, 1.0, 1e3}) {
    NewtonSolve newton;
    const ProximalStep step = proximal_step(*W, solution, alpha, 1e-9, newton);
    EXPECT_LT((step.r - solution.r).norm(), 1e-8 * solution.r.norm()) << "alpha " << alpha;
  }
}

// Near a solution the factors of one step serve the next, and lead to the same answer (PROX-10).
TEST(ProximalNewton, UsesAFactorisationAgain) {
  Random random(5);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 20, 0.2);
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-13});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  const auto inverse = invert_mass(problem.M);
  const auto bodies = make_delassus(problem, *inverse), contacts = make_delassus(condense(problem));
  for (Delassus* W : {bodies.get(), contacts.get()}) {
    const VecX r = scaled_start(W->scaled, s.r);
    const double alpha = 1e-2, away = 1e-6;
    const Iterate first = judged(*W, (1 + away) * r, Method::automatic);
    NewtonSolve kept, fresh;
    const ProximalStep once = proximal_step(*W, first, alpha, 1e-9, kept);
    ASSERT_TRUE(once.solved);
    EXPECT_GE(once.factorised, 1);
    const Iterate second = judged(*W, once.r, Method::automatic);
    const ProximalStep again = proximal_step(*W, second, alpha, 1e-9, kept),
                       anew = proximal_step(*W, second, alpha, 1e-9, fresh);
    EXPECT_TRUE(again.solved);
    EXPECT_EQ(again.factorised, 0);
    EXPECT_TRUE(anew.solved);
    EXPECT_LE((again.r - anew.r).norm(), 1e-9 * away * r.norm() + 1e-14 * r.norm());
  }
}

TEST(ProximalNewton, WorksOnManyVelocities) {
  const FrictionProblem problem = cube_stack(40, 1.0, 0.5);  // 240 velocities: the sparse branch
  const FrictionSolution s = solve(problem, {}, {.method = Method::proximal_newton, .tolerance = 1e-10});
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_EQ(s.report.found_by, Method::proximal_newton);
  EXPECT_NEAR(s.r[0] + s.r[3] + s.r[6] + s.r[9], 40 * 9.81e-3, 1e-6 * 40 * 9.81e-3);
}

// The promise to an assembly replay: each of 2000 random pegs is solved, and quickly in sweeps.
class PegInHole : public ::testing::TestWithParam<double> {};

TEST_P(PegInHole, IsSolvedEveryTime) {
  const double tolerance = GetParam();
  int by_others = 0;
  std::vector<int> sweeps, newton;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Random random(seed);
    const int bodies = 1 + int(seed % 2), contacts = 4 + int(random.uniform(0, 147));
    const FrictionProblem problem = random_peg_in_hole(random, bodies, contacts, 0.2);
    const FrictionSolution s = solve(problem, {}, {.tolerance = tolerance});
    ASSERT_EQ(s.report.status, SolveStatus::converged)
        << "seed " << seed << ", " << contacts << " contacts, residual " << s.report.residual;
    by_others += s.report.found_by != Method::nsgs;
    sweeps.push_back(s.report.iterations);
    newton.push_back(s.report.newton_iterations);
    if (seed % 20 == 0) {
      ASSERT_LT(scaled_residual(condense(problem), s.r), tolerance + 1e-13) << "seed " << seed;
    }
  }
  const auto percentile_99 = [](std::vector<int> x) {
    std::nth_element(x.begin(), x.begin() + 1980, x.end());
    return x[1980];
  };
  EXPECT_GT(by_others, 1400);  // the sample is hyperstatic indeed
  EXPECT_LE(percentile_99(sweeps), 100);
  EXPECT_LE(percentile_99(newton), 100);
}
INSTANTIATE_TEST_SUITE_P(Tolerances, PegInHole, ::testing::Values(1e-8, 1e-12));

TEST(PegInHole, NeedsTheSecondPhase) {
  int stuck = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1, 50, 0.2);
    const FrictionSolution s = solve(problem, {}, {.method = Method::nsgs, .max_iterations = 300});
    stuck += s.report.status != SolveStatus::converged;
  }
  EXPECT_GT(stuck, 10);
}

}  // namespace
}  // namespace aussois
