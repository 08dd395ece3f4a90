// SPDX-License-Identifier: Apache-2.0
// What ADMM and the interior point rest on, and what is true of them alone.
#include <algorithm>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "nsgs/delassus.hpp"
#include "nsgs/factorised.hpp"
#include "nsgs/mass_inverse.hpp"
#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/planted_problem.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

TEST(Factorised, SolvesDenseSymmetricAndUnsymmetricMatrices) {
  for (const int n : {5, 200})
    for (const bool symmetric : {true, false}) {
      Random random(3);
      std::vector<Triplet> entries;
      for (int i = 0; i < n; ++i) {
        entries.emplace_back(i, i, 4);
        if (i == 0) continue;
        entries.emplace_back(i, i - 1, -1);
        entries.emplace_back(i - 1, i, symmetric ? -1 : -0.5);
      }
      SparseMatrix A(n, n);
      A.setFromTriplets(entries.begin(), entries.end());
      const VecX x = uniform_vector(random, n, -1, 1);
      const LinearSolve solve = factorised(A);
      ASSERT_TRUE(solve);
      EXPECT_LT((solve(A * x) - x).norm(), 1e-13 * x.norm()) << n;
    }
}

TEST(Factorised, IsEmptyForASingularMatrix) {
  for (const int n : {3, 200}) {
    SparseMatrix A(n, n);
    A.setIdentity();
    A.coeffRef(1, 1) = 0;
    EXPECT_FALSE(factorised(A)) << n;
  }
}

TEST(Delassus, HasTheSameMatrixBlocksAndShiftedInverseInBothForms) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const FrictionProblem problem =
        seed % 2 == 0 ? random_peg_in_hole(random, 2, 30, 0.2)
                      : planted(random, random_laws(random, 21), 300, 0.1).problem;  // sparse and dense
    const std::unique_ptr<Delassus> bodies = make_delassus(problem, *invert_mass(problem.M)),
                                    contacts = make_delassus(condense(problem));
    const MatX W = contacts->matrix();
    EXPECT_LT((MatX(bodies->matrix()) - W).norm(), 1e-12 * W.norm()) << "seed " << seed;
    const VecX b = uniform_vector(random, int(W.rows()), -1, 1);
    const VecX x = (W + 0.1 * MatX::Identity(W.rows(), W.rows())).partialPivLu().solve(b);
    for (const Delassus* form : {bodies.get(), contacts.get()}) {
      EXPECT_LT((form->shifted_inverse(0.1)(b) - x).norm(), 1e-11 * x.norm()) << "seed " << seed;
      for (int c = 0; c < form->count(); ++c) {
        const int k = form->first[c], rows = form->scaled.laws[c].rows;
        EXPECT_LT((form->block(c) - W.block(k, k, rows, rows)).norm(), 1e-12) << "seed " << seed;
      }
    }
  }
}

TEST(Delassus, GivesBlocksThatFeelEachOtherDifferentColours) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const FrictionProblem problem = seed % 2 == 0
                                        ? bead_chains({7, 1, 30}, 0.3)
                                        : planted(random, random_laws(random, 21), 300, 0.1).problem;
    const std::unique_ptr<Delassus> bodies = make_delassus(problem, *invert_mass(problem.M)),
                                    contacts = make_delassus(condense(problem));
    const MatX W = contacts->matrix();
    for (const Delassus* form : {bodies.get(), contacts.get()}) {
      const std::vector<int> colours = form->colours();
      ASSERT_EQ(colours.size(), std::size_t(form->count()));
      if (seed % 2 == 0) {
        EXPECT_EQ(*std::ranges::max_element(colours), 1);  // two colours do for chains
      }
      for (int c = 0; c < form->count(); ++c)
        for (int d = 0; d < c; ++d) {
          const auto block =
              W.block(form->first[c], form->first[d], form->scaled.laws[c].rows, form->scaled.laws[d].rows);
          EXPECT_TRUE(block.isZero(0) || colours[c] != colours[d]) << c << " " << d;
        }
    }
  }
}

TEST(Admm, StaysNearASolutionThatItIsGiven) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Planted made = planted(random, random_laws(random, 7), 36);
    const SolverOptions options{.method = Method::admm, .tolerance = 1e-6};
    const VecX near = made.r + 1e-6 * uniform_vector(random, int(made.r.size()), -1, 1);
    const FrictionSolution warm = solve(made.problem, near, options), cold = solve(made.problem, {}, options);
    ASSERT_EQ(warm.report.status, SolveStatus::converged) << "seed " << seed;
    EXPECT_LT(warm.report.iterations, cold.report.iterations / 2 + 1) << "seed " << seed;
  }
}

TEST(InteriorPoint, IsAReferenceToThirteenDigits) {
  int most = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const Planted made = planted(random, random_laws(random, 3 + int(seed % 10)), 60, 0.02);
    const FrictionSolution s = solve(
        made.problem, {}, {.method = Method::interior_point, .tolerance = 1e-13, .max_iterations = 100});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed << " at " << s.report.residual;
    EXPECT_LT((s.u - made.u).norm(), 1e-9 * (1 + made.u.norm())) << "seed " << seed;
    most = std::max(most, s.report.iterations);
  }
  EXPECT_LE(most, 40);
}

TEST(InteriorPoint, TakesRowsWithoutFrictionAsTheyAre) {
  Random random(4);
  const std::vector<Law> laws = {coulomb(0),        coulomb_2d(0),   rolling(0.2, 0), rolling(0, 0.1),
                                 contensou(0, 0.3), dry_friction(0), coulomb(0.3)};
  const Planted made = planted(random, laws, 60);
  const FrictionSolution s = solve(made.problem, {}, {.method = Method::interior_point, .tolerance = 1e-12});
  ASSERT_EQ(s.report.status, SolveStatus::converged) << s.report.residual;
  EXPECT_LT((s.u - made.u).norm(), 1e-9 * (1 + made.u.norm()));
}

TEST(InteriorPoint, GetsHalfTheDigitsWhereAContactIsClosedWithoutLoad) {
  // u = r + q with q = 0 in a contact: p and d both go to zero. The promise of interior_point.md is the root.
  LocalProblem problem;
  problem.W = SparseMatrix(MatX::Identity(6, 6).sparseView());
  problem.q = VecX::Zero(6);
  problem.q[3] = -1;
  problem.laws = {coulomb(0.5), coulomb(0.5)};
  const FrictionSolution s = solve(problem, {}, {.method = Method::interior_point, .tolerance = 1e-7});
  EXPECT_EQ(s.report.status, SolveStatus::converged) << s.report.residual;
}

}  // namespace
}  // namespace aussois
