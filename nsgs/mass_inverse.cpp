// SPDX-License-Identifier: Apache-2.0
#include "nsgs/mass_inverse.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/LU>
#include <Eigen/SparseLU>

namespace aussois {

struct SparseFactor {
  Eigen::SparseLU<SparseMatrix> lu{};
};

namespace {

bool all_finite(const SparseMatrix& M) {
  for (int j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it)
      if (!std::isfinite(it.value())) return false;
  return true;
}

// Connected components of the graph of M, by union-find whose roots are the smallest rows.
std::vector<MassBlock> coupled_rows(const SparseMatrix& M) {
  std::vector<int> parent(std::size_t(M.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[std::size_t(i)] != i)
      i = parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
    return i;
  };
  for (int j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) {
      if (it.value() == 0) continue;
      const int a = root(int(it.row())), b = root(j);
      parent[std::size_t(std::max(a, b))] = std::min(a, b);
    }
  std::vector<MassBlock> blocks;
  std::vector<int> block_of_root(parent.size(), -1);
  for (int i = 0; i < int(parent.size()); ++i) {
    int& index = block_of_root[std::size_t(root(i))];
    if (index < 0) {
      index = int(blocks.size());
      blocks.emplace_back();
    }
    blocks[std::size_t(index)].rows.push_back(i);
  }
  return blocks;
}

MatX dense_block(const SparseMatrix& M, const std::vector<int>& rows) {
  const Eigen::Index size = Eigen::Index(rows.size());
  MatX block(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j) block(i, j) = M.coeff(rows[std::size_t(i)], rows[std::size_t(j)]);
  return block;
}

}  // namespace

VecX MassInverse::operator*(const VecX& x) const {
  if (factor) return factor->lu.solve(x);
  VecX y(x.size());
  for (const MassBlock& block : blocks) {
    const Eigen::Index size = Eigen::Index(block.rows.size());
    for (Eigen::Index i = 0; i < size; ++i) {
      double sum = 0;
      for (Eigen::Index j = 0; j < size; ++j) sum += block.inverse(i, j) * x[block.rows[std::size_t(j)]];
      y[block.rows[std::size_t(i)]] = sum;
    }
  }
  return y;
}

SparseMatrix MassInverse::operator*(const SparseMatrix& X) const {
  std::vector<Triplet> entries;
  std::vector<int> touched;
  for (int j = 0; j < X.outerSize(); ++j) {
    if (factor) {
      const VecX y = factor->lu.solve(VecX(X.col(j)));
      for (int i = 0; i < y.size(); ++i)
        if (y[i] != 0) entries.emplace_back(i, j, y[i]);
      continue;
    }
    touched.clear();
    for (SparseMatrix::InnerIterator it(X, j); it; ++it) touched.push_back(block_of[std::size_t(it.row())]);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const int index : touched) {
      const MassBlock& block = blocks[std::size_t(index)];
      VecX x(Eigen::Index(block.rows.size()));
      for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = X.coeff(block.rows[std::size_t(k)], j);
      const VecX y = block.inverse * x;
      for (Eigen::Index k = 0; k < x.size(); ++k) entries.emplace_back(block.rows[std::size_t(k)], j, y[k]);
    }
  }
  SparseMatrix Y(X.rows(), X.cols());
  Y.setFromTriplets(entries.begin(), entries.end());
  return Y;
}

std::optional<MassInverse> invert_mass(const SparseMatrix& M) {
  if (!all_finite(M)) return std::nullopt;
  MassInverse result;
  result.blocks = coupled_rows(M);
  const bool small = std::all_of(result.blocks.begin(), result.blocks.end(), [](const MassBlock& block) {
    return block.rows.size() <= std::size_t(kLargestMassBlock);
  });
  if (!small) {
    result.blocks.clear();
    result.factor = std::make_shared<SparseFactor>();
    result.factor->lu.compute(M);
    if (result.factor->lu.info() != Eigen::Success) return std::nullopt;
    return result;
  }
  result.block_of.resize(std::size_t(M.rows()));
  for (std::size_t b = 0; b < result.blocks.size(); ++b) {
    MassBlock& block = result.blocks[b];
    for (const int row : block.rows) result.block_of[std::size_t(row)] = int(b);
    const MatX dense = dense_block(M, block.rows);
    // Rows and columns scaled by the diagonal: kg beside kg m^2 is not ill-conditioning.
    const VecX scale = dense.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
    if (!scale.allFinite()) return std::nullopt;
    const Eigen::FullPivLU<MatX> lu(scale.asDiagonal() * dense * scale.asDiagonal());
    if (!lu.isInvertible()) return std::nullopt;
    block.inverse = scale.asDiagonal() * lu.inverse() * scale.asDiagonal();
  }
  return result;
}

}  // namespace aussois
