// SPDX-License-Identifier: Apache-2.0
#include "nsgs/mass_factor.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace aussois {
namespace {

constexpr double kRounded = 1e-14;  // of the terms of a row: what rounding leaves of a few dozen of them

// The block on its own, scaled.
SparseMatrix scaled_block(const SparseMatrix& M, std::span<const int> rows, const VecX& scale) {
  std::vector<int> place(std::size_t(M.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) place[rows[i]] = int(i);
  const auto n = Eigen::Index(rows.size());
  SparseMatrix out(n, n);
  Eigen::Index entries = 0;
  for (const int j : rows) entries += M.outerIndexPtr()[j + 1] - M.outerIndexPtr()[j];
  out.reserve(entries);
  for (Eigen::Index j = 0; j < n; ++j) {
    out.startVec(j);
    for (SparseMatrix::InnerIterator it(M, rows[j]); it; ++it)
      if (const int i = place[it.row()]; i >= 0)
        out.insertBackByOuterInner(j, i) = scale[i] * it.value() * scale[j];
  }
  out.finalize();
  return out;
}

// Rows of one body are six of M that follow each other, from a multiple of six: so they are numbered.
BodyLu elimination(const SparseMatrix& A, std::span<const int> rows) {
  std::vector<int> body(rows.size());
  for (std::size_t i = 1; i < rows.size(); ++i)
    body[i] = body[i - 1] + (rows[i] / kBodyRows != rows[i - 1] / kBodyRows);
  std::vector<std::pair<int, int>> couplings;
  std::vector<int> met(std::size_t(body.back()) + 1, -1);  // with which body each was met last
  for (int j = 0; j < A.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(A, j); it; ++it)
      if (const int other = body[it.row()]; other != body[j] && std::exchange(met[other], body[j]) != body[j])
        couplings.emplace_back(other, body[j]);
  return {std::move(body), couplings};
}

bool factorise(const SparseMatrix& A, BodyLu& lu) {
  std::vector<Mat6> blocks = lu.zero();
  for (int j = 0; j < A.outerSize(); ++j) {
    int of = -1, block = 0;
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      if (const int b = lu.body(int(it.row())); b != of) of = b, block = lu.block(b, lu.body(j));
      blocks[block](lu.place(int(it.row())), lu.place(j)) = it.value();
    }
  }
  return lu.factorise(std::move(blocks));
}

// Whether one solution leaves no more than rounding. Pivots are not sought outside a body, so a block that is
// not close to symmetric and positive may lose any number of digits.
bool is_sound(const SparseMatrix& A, const BodyLu& lu) {
  VecX b(A.rows());
  for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = 1 + double(i % 7) / 8;
  const VecX x = lu.solve(b);
  const VecX left = b - A * x, terms = b + A.cwiseAbs() * x.cwiseAbs();
  return (left.array().abs() <= kRounded * terms.array()).all();
}

}  // namespace

std::shared_ptr<const MassFactor> mass_factor(const SparseMatrix& M, std::span<const int> rows,
                                              const MassFactor* like) {
  VecX scale(Eigen::Index(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    scale[Eigen::Index(i)] = 1 / std::sqrt(std::abs(M.coeff(rows[i], rows[i])));
  if (!scale.allFinite()) return nullptr;
  const SparseMatrix A = scaled_block(M, rows, scale);
  auto out = std::make_shared<MassFactor>(
      MassFactor{.scale = std::move(scale), .lu = like ? like->lu.again() : elimination(A, rows)});
  if (factorise(A, out->lu) && is_sound(A, out->lu)) return out;
  out->pivoted = std::make_unique<Eigen::SparseLU<SparseMatrix>>(A);
  return out->pivoted->info() == Eigen::Success ? out : nullptr;
}

VecX solve(const MassFactor& factor, const VecX& x) {
  const VecX b = factor.scale.cwiseProduct(x);
  return factor.scale.cwiseProduct(factor.pivoted ? VecX(factor.pivoted->solve(b)) : factor.lu.solve(b));
}

}  // namespace aussois
