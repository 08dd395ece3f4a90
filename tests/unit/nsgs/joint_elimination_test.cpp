// SPDX-License-Identifier: Apache-2.0
#include "nsgs/joint_elimination.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

// Two bodies on the ground, held together by `rows` random directions.
FrictionProblem jointed(Random& random, int rows, double mu = 0.3) {
  FrictionProblem problem = random_peg_in_hole(random, 2, 8, mu);
  problem.G = MatX(uniform_vector(random, 12 * rows, -1, 1).reshaped(12, rows)).sparseView();
  problem.b = uniform_vector(random, rows, -1e-3, 1e-3);
  return problem;
}

TEST(JointElimination, CondensesLikeDenseAlgebra) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const FrictionProblem problem = jointed(random, 1 + int(seed % 5));
    const MatX inverse = MatX(problem.M).inverse(), G = problem.G, H = problem.H;
    const MatX S = G.transpose() * inverse * G;
    const MatX P = inverse - inverse * G * S.inverse() * G.transpose() * inverse;
    const LocalProblem local = condense(problem);
    const MatX W = H.transpose() * P * H;
    const VecX q = H.transpose() * (P * problem.f - inverse * G * S.inverse() * problem.b) + problem.w;
    EXPECT_LT((MatX(local.W) - W).norm(), 1e-9 * W.norm()) << "seed " << seed;
    EXPECT_LT((local.q - q).norm(), 1e-9 * q.norm()) << "seed " << seed;
  }
}

// What is locked does not move, so its mass does not matter: P = Z (Z^T M Z)^-1 Z^T on the null space Z of
// G^T.
TEST(JointElimination, CondensesLightDirectionsThatAreLockedLikeTheNullSpace) {
  for (const double light : {1e-6, 1e-9, 1e-12})
    for (unsigned seed = 0; seed < 20; ++seed) {
      Random random(seed);
      FrictionProblem problem = jointed(random, 5);
      const VecX d = VecX(uniform_vector(random, 12, -1, 1)).normalized();
      MatX G(12, 7), M = problem.M;
      G.leftCols(5) = MatX(problem.G);
      G.col(5) = G.col(4) + 0.7 * d;   // d is in the range of G, and in no column alone
      G.col(6) = G.col(0) - G.col(5);  // one column is redundant
      const VecX Md = M * d;
      M -= (1 - light) / d.dot(Md) * Md * Md.transpose();  // positive definite
      problem.M = M.sparseView();
      problem.G = G.sparseView();
      problem.b = VecX::Zero(7);
      const MatX Z = MatX(G.transpose()).fullPivLu().kernel(), H = problem.H;
      ASSERT_EQ(Z.cols(), 6);
      const MatX P = Z * (Z.transpose() * M * Z).inverse() * Z.transpose(), W = H.transpose() * P * H;
      const LocalProblem local = condense(problem);
      const VecX q = H.transpose() * P * problem.f + problem.w;
      EXPECT_LT((MatX(local.W) - W).norm(), 1e-9 * W.norm()) << "seed " << seed << ", " << light;
      EXPECT_LT((local.q - q).norm(), 1e-9 * (problem.f.norm() + q.norm()))
          << "seed " << seed << ", " << light;
    }
}

TEST(JointElimination, SolutionsObeyTheJointsAndTheMomentum) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const FrictionProblem problem = jointed(random, 1 + int(seed % 5));
    const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-10});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
    EXPECT_LT((problem.G.transpose() * s.v + problem.b).norm(), 1e-10 * s.v.norm()) << "seed " << seed;
    EXPECT_LT((problem.M * s.v - problem.H * s.r - problem.G * s.lambda - problem.f).norm(),
              1e-10 * problem.f.norm())
        << "seed " << seed;
  }
}

TEST(JointElimination, DoubledJointsMoveAlikeAndShareTheirImpulse) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const FrictionProblem once = jointed(random, 3, 0);  // without friction the velocity is unique
    FrictionProblem twice = once;
    MatX G(12, 6);
    G << MatX(once.G), MatX(once.G);
    twice.G = G.sparseView();
    twice.b = once.b.replicate(2, 1);
    const FrictionSolution a = solve(once, {}, {.tolerance = 1e-12}),
                           b = solve(twice, {}, {.tolerance = 1e-12});
    ASSERT_EQ(a.report.status, SolveStatus::converged) << "seed " << seed;
    ASSERT_EQ(b.report.status, SolveStatus::converged) << "seed " << seed;
    EXPECT_LT((a.v - b.v).norm(), 1e-10 * a.v.norm()) << "seed " << seed;
    // Smallest norm: two equal joints carry half each.
    EXPECT_LT((b.lambda.head(3) - b.lambda.tail(3)).norm(), 1e-6 * a.lambda.norm()) << "seed " << seed;
    EXPECT_LT((b.lambda.head(3) + b.lambda.tail(3) - a.lambda).norm(), 1e-6 * a.lambda.norm())
        << "seed " << seed;
  }
}

TEST(JointElimination, BilateralRowsAreJointsToo) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const FrictionProblem joint = jointed(random, 3, 0);
    FrictionProblem rows = joint;
    MatX H(12, 27);
    H << MatX(joint.H), MatX(joint.G);
    rows.H = H.sparseView();
    rows.w.resize(27);
    rows.w << joint.w, joint.b;
    rows.laws.push_back(bilateral(3));
    rows.G = SparseMatrix();
    rows.b = VecX();
    const FrictionSolution a = solve(joint, {}, {.tolerance = 1e-12}),
                           b = solve(rows, {}, {.tolerance = 1e-12});
    ASSERT_EQ(b.report.status, SolveStatus::converged) << "seed " << seed;
    EXPECT_LT((a.v - b.v).norm(), 1e-8 * a.v.norm()) << "seed " << seed;
  }
}

TEST(JointElimination, CompliancePenetratesByWhatItCarries) {
  FrictionProblem problem = cube_stack(1, 2.0, 0.5);
  problem.R = VecX::Constant(12, 1e-3 / 2.0);
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-12});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  // Four equal springs: u = v_N + R r_N = 0 and 2 v_N = 4 r_N - 2 g h.
  const double r = 2 * 9.81e-3 / (4 + 2 * problem.R[0]);
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(s.r[3 * c], r, 1e-9 * r);
  EXPECT_NEAR(s.v[2], -problem.R[0] * s.r[0], 1e-12);
}

}  // namespace
}  // namespace aussois
