// SPDX-License-Identifier: Apache-2.0
#include "nsgs/sparse_lu.hpp"

#include <algorithm>
#include <klu.h>
#include <memory>
#include <numeric>

#include <Eigen/LU>
#include <Eigen/OrderingMethods>

namespace aussois {

namespace {

constexpr int kDenseSize = 64;
// Of the entries that are there: above, and up to kLargestDense rows, as where bodies that deform couple all
// their contacts, a dense factorisation takes a fifth of the time
constexpr double kDensity = 0.5;
constexpr int kLargestDense = 3000;
constexpr double kSlowness = 3;  // of KLU's operations beside those of a product with small blocks, measured

bool is_dense(const CompressedColumns& J) {
  const double n = J.size();
  return n <= kDenseSize || (n <= kLargestDense && double(J.value.size()) > kDensity * n * n);
}

// Read row by row, the neighbours that every node is one of must come as those that it has.
bool is_symmetric(const std::vector<int>& begin, const std::vector<int>& other) {
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < next.size(); ++i)
    for (auto k = std::size_t(begin[i]); k < std::size_t(begin[i + 1]); ++k) {
      const auto j = std::size_t(other[k]);
      if (next[j] == begin[j + 1] || other[next[j]++] != int(i)) return false;
    }
  return true;
}

}  // namespace

CompressedColumns compressed(const SparseMatrix& A) {
  return {{A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1},
          {A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros()},
          {A.valuePtr(), A.valuePtr() + A.nonZeros()}};
}

std::vector<int> fill_reducing_order(const std::vector<int>& begin, const std::vector<int>& other) {
  const Eigen::Index n = Eigen::Index(begin.size()) - 1;
  Eigen::SparseMatrix<char, Eigen::ColMajor, int> graph(n, n);
  graph.resizeNonZeros(Eigen::Index(other.size()));
  std::ranges::copy(begin, graph.outerIndexPtr());
  std::ranges::copy(other, graph.innerIndexPtr());
  std::fill_n(graph.valuePtr(), other.size(), char(0));
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  if (is_symmetric(begin, other))  // AMDOrdering adds the transposed first, which costs as much as the order
    Eigen::internal::minimum_degree_ordering(graph, permutation);
  else
    Eigen::AMDOrdering<int>()(graph, permutation);
  return {permutation.indices().data(), permutation.indices().data() + n};
}

double factor_cost(CompressedColumns& J) {
  const double n = J.size();
  if (is_dense(J)) return 2 * n * n * n / 3;
  klu_common common;
  klu_defaults(&common);
  klu_symbolic* symbolic = klu_analyze(J.size(), J.begin.data(), J.row.data(), &common);
  const double flops = symbolic ? kSlowness * symbolic->est_flops : kInf;
  klu_free_symbolic(&symbolic, &common);
  return flops;
}

std::function<VecX(const VecX&)> inverse_of(CompressedColumns J) {
  const int n = J.size();
  if (is_dense(J)) {
    MatX dense = MatX::Zero(n, n);
    for (int j = 0; j < n; ++j)
      for (int k = J.begin[j]; k < J.begin[std::size_t(j) + 1]; ++k) dense(J.row[k], j) = J.value[k];
    const auto factor = std::make_shared<Eigen::PartialPivLU<MatX>>(dense);
    return [factor](const VecX& b) -> VecX { return factor->solve(b); };
  }
  const auto common = std::make_shared<klu_common>();
  klu_defaults(common.get());
  common->scale = 0;  // the rows of the scaled problem are of one size
  common->btf = 0;
  const auto free_symbolic = [common](klu_symbolic* s) { klu_free_symbolic(&s, common.get()); };
  const auto free_numeric = [common](klu_numeric* f) { klu_free_numeric(&f, common.get()); };
  const std::shared_ptr<klu_symbolic> symbolic(
      klu_analyze_given(n, J.begin.data(), J.row.data(), nullptr, nullptr, common.get()), free_symbolic);
  if (!symbolic) return {};
  const std::shared_ptr<klu_numeric> numeric(
      klu_factor(J.begin.data(), J.row.data(), J.value.data(), symbolic.get(), common.get()), free_numeric);
  if (!numeric) return {};
  return [common, symbolic, numeric, n](const VecX& b) -> VecX {
    VecX x = b;
    klu_solve(symbolic.get(), numeric.get(), n, 1, x.data(), common.get());
    return x;
  };
}

}  // namespace aussois
