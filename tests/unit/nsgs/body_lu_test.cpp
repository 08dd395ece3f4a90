// SPDX-License-Identifier: Apache-2.0
#include "nsgs/body_lu.hpp"

#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <gtest/gtest.h>

#include "nsgs/sparse_lu.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Couplings = std::vector<std::pair<int, int>>;

// Rows of bodies with 6, 3, 1, 6, 3, 1, ... of them.
std::vector<int> mixed_rows(int bodies) {
  std::vector<int> body;
  for (int b = 0; b < bodies; ++b)
    body.insert(body.end(), std::size_t(b % 3 == 0 ? 6 : b % 3 == 1 ? 3 : 1), b);
  return body;
}

// Unsymmetric, with large entries where two rows are of coupled bodies.
MatX random_matrix(const std::vector<int>& body, const Couplings& couplings, Random& random) {
  const auto n = Eigen::Index(body.size());
  MatX A = MatX::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const int a = body[i], b = body[j];
      const bool coupled = a == b || std::ranges::count(couplings, std::pair(a, b)) > 0 ||
                           std::ranges::count(couplings, std::pair(b, a)) > 0;
      if (coupled) A(i, j) = random.uniform(-1, 1) + (i == j ? 20 : 0);
    }
  return A;
}

std::vector<Mat6> blocks_of(const BodyLu& lu, const MatX& A) {
  std::vector<Mat6> blocks = lu.zero();
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j)
      if (A(i, j) != 0) blocks[lu.block(lu.body(i), lu.body(j))](lu.place(i), lu.place(j)) = A(i, j);
  return blocks;
}

TEST(BodyLu, SolvesWhatADenseFactorisationSolves) {
  Random random(91);
  for (int sample = 0; sample < 100; ++sample) {
    const int bodies = 1 + random.index(12);
    Couplings couplings;
    for (int k = random.index(2 * bodies); k > 0; --k)
      couplings.push_back({random.index(bodies), random.index(bodies)});
    const std::vector<int> body = mixed_rows(bodies);
    const MatX A = random_matrix(body, couplings, random);
    const VecX b = VecX::LinSpaced(A.rows(), -1, 2);
    BodyLu lu(body, couplings);
    ASSERT_TRUE(lu.factorise(blocks_of(lu, A))) << sample;
    EXPECT_LT((lu.solve(b) - A.partialPivLu().solve(b)).norm(), 1e-12 * b.norm()) << sample;
  }
}

// Leaves before the trunk: a product of blocks for a leaf's pivot, its row, and what it leaves on the trunk.
TEST(BodyLu, OfStarsAndChainsGrowsWithTheirLength) {
  for (const int bodies : {10, 100, 1000}) {
    Couplings star, chain;
    for (int b = 1; b < bodies; ++b) star.emplace_back(0, b), chain.emplace_back(b - 1, b);
    std::vector<int> body;
    for (int i = 0; i < 6 * bodies; ++i) body.push_back(i / 6);
    EXPECT_LE(BodyLu(body, star).cost(), 3 * 216 * bodies);
    EXPECT_LE(BodyLu(body, chain).cost(), 3 * 216 * bodies);
  }
}

// Eigen's own entry adds the transposed to the graph first, which changes nothing in a symmetric one.
TEST(FillReducingOrder, IsThatOfTheGraphAndItsTransposed) {
  Random random(31);
  for (const bool symmetric : {true, false})
    for (int n = 1; n < 60; ++n) {
      MatX dense = MatX::Identity(n, n);
      for (int k = 0; k < 2 * n; ++k) {
        const int i = random.index(n), j = random.index(n);
        dense(i, j) = 1;
        if (symmetric) dense(j, i) = 1;
      }
      const SparseMatrix graph = dense.sparseView();
      const CompressedColumns columns = compressed(graph);
      Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> expected;
      Eigen::AMDOrdering<int>()(graph, expected);
      const std::vector<int> order = fill_reducing_order(columns.begin, columns.row);
      for (int i = 0; i < n; ++i)
        EXPECT_EQ(order[i], expected.indices()[i]) << n << (symmetric ? " symmetric" : "");
    }
}

TEST(BodyLu, RefusesASingularPivotAndWhatIsNotFinite) {
  BodyLu lu({0, 0, 1}, {{0, 1}});
  MatX A = MatX::Identity(3, 3);
  A(0, 0) = 0;
  EXPECT_FALSE(lu.factorise(blocks_of(lu, A)));
  A(0, 0) = std::nan("");
  EXPECT_FALSE(lu.factorise(blocks_of(lu, A)));
}

}  // namespace
}  // namespace aussois
