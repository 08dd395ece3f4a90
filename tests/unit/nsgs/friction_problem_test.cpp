// SPDX-License-Identifier: Apache-2.0

#include "nsgs/friction_problem.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "nsgs/mass_inverse.hpp"
#include "tests/support/message_of.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

SparseMatrix random_band_matrix(Random& random, int n) {  // diagonally dominant, unsymmetric, one component
  std::vector<Triplet> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, random.uniform(3, 4));
    if (i > 0) entries.emplace_back(i, i - 1, random.uniform(-1, 1));
    if (i + 1 < n) entries.emplace_back(i, i + 1, random.uniform(-1, 1));
  }
  SparseMatrix M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

TEST(FrictionProblem, NamesTheFieldThatIsWrong) {
  Random random(1);
  const FrictionProblem good = random_peg_in_hole(random, 1, 5, 0.2);
  EXPECT_NO_THROW(validate(good));
  FrictionProblem bad = good;
  bad.w.conservativeResize(14);
  EXPECT_NE(message_of([&] {
              validate(bad);
            }).find("FrictionProblem::w.size() = 14 must equal the rows of laws = 15"),
            std::string::npos);
  bad = good;
  bad.f.conservativeResize(5);
  EXPECT_NE(message_of([&] { validate(bad); }).find("FrictionProblem::M.rows() = 6"), std::string::npos);
  bad = good;
  bad.laws[3].mu = -0.1;
  EXPECT_NE(message_of([&] { validate(bad); }).find("laws[3].mu = -0.1"), std::string::npos);
  bad.laws[3].mu = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(bad), std::invalid_argument);
  bad = good;
  bad.H = SparseMatrix(7, 15);
  EXPECT_NE(message_of([&] { validate(bad); }).find("FrictionProblem::H.rows() = 7"), std::string::npos);
}

TEST(FrictionProblem, NamesTheLawThatIsWrong) {
  LocalProblem problem{.W = SparseMatrix(4, 4), .q = VecX::Zero(4), .laws = {contensou(0.3, 0.01)}};
  EXPECT_NO_THROW(validate(problem));
  problem.laws[0].radius = 0;
  EXPECT_NE(message_of([&] { validate(problem); }).find("laws[0].radius = 0 must be finite and > 0"),
            std::string::npos);
  problem.laws[0] = rolling(0.3, 0.1);
  EXPECT_NE(message_of([&] { validate(problem); }).find("LocalProblem::W.rows() = 4"), std::string::npos);
  problem.laws[0].rows = 4;
  EXPECT_NE(message_of([&] { validate(problem); }).find("laws[0].rows = 4 must be 5"), std::string::npos);
  problem.laws = {bilateral(7)};
  EXPECT_THROW(validate(problem), std::invalid_argument);
  problem.laws = {unilateral(), dry_friction(-1), coulomb_2d(0.1)};
  EXPECT_NE(message_of([&] { validate(problem); }).find("laws[1].limit = -1"), std::string::npos);
}

TEST(FrictionProblem, CondensesLikeDenseAlgebra) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 12, 0.2);
    const LocalProblem local = condense(problem);
    const MatX inverse = MatX(problem.M).inverse(), H = problem.H;
    const MatX W = H.transpose() * inverse * H;
    const VecX q = H.transpose() * (inverse * problem.f) + problem.w;
    EXPECT_LT((MatX(local.W) - W).norm(), 1e-12 * W.norm()) << "seed " << seed;
    EXPECT_LT((local.q - q).norm(), 1e-12 * q.norm()) << "seed " << seed;
    const VecX r = uniform_vector(random, 36, -1, 1);
    EXPECT_LT((local.W * r - W * r).norm(), 1e-12 * W.norm() * r.norm());
    EXPECT_GT((W - W.transpose()).norm(), 1e-9 * W.norm());  // the sample is unsymmetric indeed
  }
}

TEST(FrictionProblem, CondensesACoupledMassMatrixToo) {
  Random random(3);
  FrictionProblem problem = random_peg_in_hole(random, 2, 4, 0.2);
  const int n = kLargestMassBlock + 36;
  problem.M = random_band_matrix(random, n);
  problem.f = uniform_vector(random, n, -1, 1);
  problem.H = MatX(uniform_vector(random, 12 * n, -1, 1).reshaped(n, 12)).sparseView();
  const MatX H = problem.H, W = H.transpose() * MatX(problem.M).inverse() * H;
  EXPECT_LT((MatX(condense(problem).W) - W).norm(), 1e-13 * W.norm());
}

TEST(FrictionProblem, WithASingularMassIsRefused) {
  Random random(4);
  FrictionProblem problem = random_peg_in_hole(random, 1, 4, 0.2);
  problem.M.coeffRef(2, 2) = 0;
  EXPECT_THROW(condense(problem), std::runtime_error);
  problem.M.coeffRef(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(condense(problem), std::runtime_error);
}

TEST(FrictionProblem, BlocksThatDoNotMeetAreNotStored) {
  // Three bodies, one contact each with the ground: W is block diagonal.
  const FrictionProblem apart{.M = block_diagonal({MatX(MatX::Identity(18, 18))}),
                              .H = contact_directions(3, {{.a = 0}, {.a = 1}, {.a = 2}}),
                              .f = VecX::Zero(18),
                              .w = VecX::Zero(9),
                              .laws = {coulomb(0.1), coulomb(0.2), coulomb(0.3)}};
  const LocalProblem local = condense(apart);
  for (int j = 0; j < 9; ++j)
    for (SparseMatrix::InnerIterator it(local.W, j); it; ++it) EXPECT_EQ(it.row() / 3, j / 3);
}

TEST(MassInverse, FindsTheRowsThatBelongTogether) {
  SparseMatrix M(5, 5);
  M.insert(0, 0) = 2;
  M.insert(1, 1) = 3;
  M.insert(1, 4) = 1;  // one direction is enough
  M.insert(2, 2) = 4;
  M.insert(3, 3) = 5;
  M.insert(4, 4) = 6;
  const std::optional<MassInverse> inverse = invert_mass(M);
  ASSERT_TRUE(inverse);
  ASSERT_EQ(inverse->count(), 4);
  EXPECT_EQ(inverse->rows, (std::vector<int>{0, 1, 4, 2, 3}));
  EXPECT_EQ(inverse->first, (std::vector<int>{0, 1, 3, 4, 5}));
  EXPECT_EQ(inverse->block_of, (std::vector<int>{0, 1, 2, 3, 1}));
  const VecX x = VecX::LinSpaced(5, 1, 5);
  EXPECT_LT((M * (*inverse * x) - x).norm(), 1e-14);
}

TEST(MassInverse, KilogramsBesideGramSquareMillimetresAreNotSingular) {
  const VecX unit = Vec6(1, 1, 1, 1e-8, 1e-8, 1e-8);  // M = unit (1 + 0.1) unit, one block
  const MatX M = unit.asDiagonal() * MatX(MatX::Identity(6, 6) + 0.1 * MatX::Ones(6, 6)) * unit.asDiagonal();
  const SparseMatrix S = M.sparseView(1, 0);
  const std::optional<MassInverse> inverse = invert_mass(S);
  ASSERT_TRUE(inverse);
  ASSERT_EQ(inverse->count(), 1);
  const VecX x = VecX::Ones(6);
  EXPECT_LT((S * (*inverse * VecX(unit.asDiagonal() * x)) - unit.asDiagonal() * x).cwiseQuotient(unit).norm(),
            1e-13);
}

}  // namespace
}  // namespace aussois
