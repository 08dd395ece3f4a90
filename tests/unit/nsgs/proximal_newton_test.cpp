// SPDX-License-Identifier: Apache-2.0
#include "nsgs/proximal_newton.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "nsgs/nsgs.hpp"
#include "nsgs/residual.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

TEST(ProximalNewton, SolvesTheCompliantProblem) {
  // (PROX-1) is a friction problem of its own, with W + alpha w_c on the diagonal: solved by sweeps to
  // compare.
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 10, 0.2);
    const LocalProblem local = condense(problem);
    const std::vector<double> w_c = contact_scales(local.W);
    const double alpha = 0.1;
    LocalProblem compliant = local;
    for (int c = 0; c < 10; ++c)
      for (int k = compliant.W.begin[std::size_t(c)]; k < compliant.W.begin[std::size_t(c) + 1]; ++k)
        if (compliant.W.column[std::size_t(k)] == c)
          compliant.W.block[std::size_t(k)] += alpha * w_c[std::size_t(c)] * Mat3::Identity();
    const FrictionSolution reference = solve_nsgs(compliant, {}, {.tolerance = 1e-12, .handover_after = 0});
    ASSERT_EQ(reference.report.status, SolveStatus::converged) << "seed " << seed;
    const VecX zero = VecX::Zero(30);
    const ProximalStep global = ProximalNewton(problem, w_c).step(zero, local.q, alpha);
    const ProximalStep condensed = ProximalNewton(local, w_c).step(zero, local.q, alpha);
    EXPECT_TRUE(global.solved && condensed.solved) << "seed " << seed;
    const double size = reference.r.norm();
    EXPECT_LE((global.r - reference.r).norm(), 1e-8 * size) << "seed " << seed;
    EXPECT_LE((condensed.r - reference.r).norm(), 1e-8 * size) << "seed " << seed;
  }
}

TEST(ProximalNewton, LeavesASolutionWhereItIs) {
  Random random(3);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 20, 0.2);
  const FrictionSolution s = solve_nsgs(problem, {}, {.tolerance = 1e-13});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  const LocalProblem local = condense(problem);
  const ProximalNewton newton(problem, contact_scales(local.W));
  for (const double alpha : {1e-3, 1.0, 1e3})
    EXPECT_LT((newton.step(s.r, s.u, alpha).r - s.r).norm(), 1e-8 * s.r.norm()) << "alpha " << alpha;
}

TEST(ProximalNewton, WorksOnManyVelocities) {
  const FrictionProblem problem = cube_stack(40, 1.0, 0.5);  // 240 velocities: the sparse branch
  ASSERT_FALSE(ProximalNewton::is_cheap(problem.f.size()));
  const FrictionSolution s = solve_nsgs(problem, {}, {.tolerance = 1e-10});
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_TRUE(s.report.finished_by_newton);
  EXPECT_NEAR(s.r[0] + s.r[3] + s.r[6] + s.r[9], 40 * 9.81e-3, 1e-6 * 40 * 9.81e-3);
}

// The promise to an assembly replay: each of 2000 random pegs is solved, and quickly in sweeps.
class PegInHole : public ::testing::TestWithParam<double> {};

TEST_P(PegInHole, IsSolvedEveryTime) {
  const double tolerance = GetParam();
  int by_newton = 0;
  std::vector<int> sweeps, newton;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Random random(seed);
    const int bodies = 1 + int(seed % 2), contacts = 4 + int(random.uniform(0, 147));
    const FrictionProblem problem = random_peg_in_hole(random, bodies, contacts, 0.2);
    const FrictionSolution s = solve_nsgs(problem, {}, {.tolerance = tolerance});
    ASSERT_EQ(s.report.status, SolveStatus::converged)
        << "seed " << seed << ", " << contacts << " contacts, residual " << s.report.residual;
    by_newton += s.report.finished_by_newton;
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
  EXPECT_GT(by_newton, 1500);  // the sample is hyperstatic indeed
  EXPECT_LE(percentile_99(sweeps), 20);
  EXPECT_LE(percentile_99(newton), 100);
}
INSTANTIATE_TEST_SUITE_P(Tolerances, PegInHole, ::testing::Values(1e-8, 1e-12));

TEST(PegInHole, NeedsTheSecondPhase) {
  int stuck = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1, 50, 0.2);
    const FrictionSolution s = solve_nsgs(problem, {}, {.max_iterations = 300, .handover_after = 0});
    stuck += s.report.status != SolveStatus::converged;
  }
  EXPECT_GT(stuck, 10);
}

}  // namespace
}  // namespace aussois
