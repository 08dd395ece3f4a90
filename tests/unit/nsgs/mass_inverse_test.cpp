// SPDX-License-Identifier: Apache-2.0
#include "nsgs/mass_inverse.hpp"

#include <limits>
#include <random>

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

}  // namespace
}  // namespace aussois
