// SPDX-License-Identifier: Apache-2.0
#include "nsgs/mass_inverse.hpp"

#include <limits>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace aussois {
namespace {

// Blocks of 1, 3, 5 and 1 rows, the rows of the last two among each other.
SparseMatrix mass(std::mt19937& random) {
  const std::vector<std::vector<int>> blocks{{0}, {1, 2, 3}, {4, 6, 7, 8, 9}, {5}};
  std::uniform_real_distribution<double> entry(-1, 1);
  std::vector<Triplet> entries;
  for (const std::vector<int>& rows : blocks)
    for (const int i : rows)
      for (const int j : rows) entries.emplace_back(i, j, entry(random) + (i == j ? 8 : 0));
  SparseMatrix M(10, 10);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

void expect_same(const std::optional<MassInverse>& a, const std::optional<MassInverse>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->rows, b->rows);
  EXPECT_EQ(a->first, b->first);
  EXPECT_EQ(a->inverse, b->inverse);
  EXPECT_EQ(a->at, b->at);
  EXPECT_EQ(a->block_of, b->block_of);
}

TEST(MassInverse, OfTheLastMatrixServesAgainBlockByBlock) {
  std::mt19937 random(1);
  SparseMatrix last_M = mass(random);
  std::optional<MassInverse> last = invert_mass(last_M);
  ASSERT_TRUE(last);
  std::uniform_int_distribution<Eigen::Index> place(0, last_M.nonZeros() - 1);
  std::uniform_real_distribution<double> factor(0.5, 1.5);
  for (int k = 0; k < 200; ++k) {
    SparseMatrix M = last_M;
    M.valuePtr()[place(random)] *= k % 10 == 0 ? 0 : factor(random);  // 0 may make it singular
    const std::optional<MassInverse> fresh = invert_mass(M);
    expect_same(invert_mass(M, last_M, *last), fresh);
    if (!fresh) continue;
    expect_same(invert_mass(last_M, M, *fresh), last);
    last_M = M;
    last = fresh;
    if (k % 10 == 0) {
      last_M = mass(random);
      last = invert_mass(last_M);
    }
  }
}

TEST(MassInverse, FindsItsBlocksAgainWhereACouplingComesOrGoes) {
  SparseMatrix coupled(2, 2);
  coupled.insert(0, 0) = 2;
  coupled.insert(0, 1) = 1;
  coupled.insert(1, 1) = 4;
  coupled.makeCompressed();
  SparseMatrix alone = coupled;
  alone.coeffRef(0, 1) = 0;  // its place stays
  const std::optional<MassInverse> one = invert_mass(coupled), two = invert_mass(alone);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->count(), 1);
  EXPECT_EQ(two->count(), 2);
  expect_same(invert_mass(alone, coupled, *one), two);
  expect_same(invert_mass(coupled, alone, *two), one);
}

TEST(MassInverse, OfTheLastMatrixIsOfNoUseToAnother) {
  std::mt19937 random(2);
  const SparseMatrix last_M = mass(random);
  const std::optional<MassInverse> last = invert_mass(last_M);
  ASSERT_TRUE(last);
  SparseMatrix other(10, 10);
  other.setIdentity();
  expect_same(invert_mass(other, last_M, *last), invert_mass(other));
  SparseMatrix larger(11, 11);
  larger.setIdentity();
  expect_same(invert_mass(larger, last_M, *last), invert_mass(larger));
  SparseMatrix bad = last_M;
  bad.coeffRef(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(invert_mass(bad, last_M, *last));
  bad.coeffRef(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(invert_mass(bad, last_M, *last));
  bad = last_M;
  bad.coeffRef(0, 0) = 0;
  EXPECT_FALSE(invert_mass(bad, last_M, *last));
}

// A chain of `bodies` bodies of six rows, two free bodies of six beside it, in units far apart.
SparseMatrix chain_mass(int bodies, double stiffness, std::mt19937& random) {
  std::uniform_real_distribution<double> entry(-1, 1);
  const int n = 6 * (bodies + 2);
  MatX M = MatX::Identity(n, n);
  for (int b = 0; b + 1 < bodies; ++b) {
    MatX A(12, 12);
    for (double& x : A.reshaped()) x = entry(random);
    M.block(6 * b + 6, 6 * b + 6, 12, 12) += stiffness * A * A.transpose();  // after the first free body
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) M(i, j) = 0.1, M(n - 1 - i, n - 1 - j) = -0.1;
  VecX unit = VecX::Ones(n);
  for (int i = 0; i < n; ++i)
    if (i % 6 >= 3) unit[i] = 1e-4;
  return (unit.asDiagonal() * M * unit.asDiagonal()).sparseView();
}

TEST(MassInverse, OfLargeBlocksIsThatOfDenseAlgebra) {
  std::mt19937 random(3);
  for (const int bodies : {5, 40}) {
    const SparseMatrix M = chain_mass(bodies, 10, random);
    const std::optional<MassInverse> inverse = invert_mass(M);
    ASSERT_TRUE(inverse);
    EXPECT_EQ(inverse->count(), 3);
    EXPECT_FALSE(inverse->factor(0));
    EXPECT_TRUE(inverse->factor(1));
    const MatX dense = MatX(M).inverse();
    const VecX x = VecX::LinSpaced(M.rows(), -1, 2);
    EXPECT_LT((*inverse * x - dense * x).norm(), 1e-11 * (dense * x).norm());
    SparseMatrix X(M.rows(), 3);
    X.insert(2, 0) = 1, X.insert(8, 0) = -2, X.insert(20, 1) = 3, X.insert(M.rows() - 1, 2) = 1;
    X.makeCompressed();
    EXPECT_LT((MatX(*inverse * X) - dense * X).norm(), 1e-11 * (dense * X).norm());
    // Of the chain and the last body alone
    std::vector<int> some;
    for (int i = 6; i < M.rows(); ++i) some.push_back(i);
    const MassInverse part = inverse_part(*inverse, some);
    const VecX all = *inverse * x, of_some = part * VecX(x(some));
    EXPECT_EQ(of_some, VecX(all(some)));
  }
}

TEST(MassInverse, OfTheLastLargeBlockServesItsOrderAlone) {
  std::mt19937 random(4);
  SparseMatrix last_M = chain_mass(20, 10, random);
  std::optional<MassInverse> last = invert_mass(last_M);
  const VecX x = VecX::LinSpaced(last_M.rows(), -1, 2);
  for (int k = 0; k < 5; ++k) {
    SparseMatrix M = last_M;
    for (Eigen::Index i = 0; i < M.nonZeros(); ++i) M.valuePtr()[i] *= 1 + 1e-3 * double((7 * i + k) % 11);
    const std::optional<MassInverse> fresh = invert_mass(M), again = invert_mass(M, last_M, *last);
    ASSERT_TRUE(fresh && again);
    EXPECT_EQ(VecX(*fresh * x), VecX(*again * x)) << "bit for bit";
    last_M = M;
    last = again;
  }
}

// Pivots within bodies vanish, or all but vanish: others take their place.
TEST(MassInverse, OfLargeBlocksThatAreNotPositiveIsSoundToo) {
  std::mt19937 random(5);
  for (const double diagonal : {1e-9, 1e-3, 1.0}) {
    const int n = 60;
    MatX M = MatX::Zero(n, n);
    std::uniform_real_distribution<double> entry(-1, 1);
    for (int b = 0; b + 6 < n; b += 6)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) M(b + i, b + 6 + j) = entry(random), M(b + 6 + i, b + j) = entry(random);
    M.diagonal().array() += diagonal;
    const std::optional<MassInverse> inverse = invert_mass(M.sparseView());
    ASSERT_TRUE(inverse) << diagonal;
    const VecX x = VecX::LinSpaced(n, 1, 2), y = *inverse * x;
    EXPECT_LT((M * y - x).norm(), 1e-13 * (M.cwiseAbs() * y.cwiseAbs()).norm()) << diagonal;
  }
  EXPECT_FALSE(invert_mass(MatX(MatX::Ones(30, 30)).sparseView()));
}

}  // namespace
}  // namespace aussois
