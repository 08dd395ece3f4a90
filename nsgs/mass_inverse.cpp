// SPDX-License-Identifier: Apache-2.0
#include "nsgs/mass_inverse.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <span>

#include <Eigen/LU>

#include "nsgs/mass_factor.hpp"

namespace aussois {

namespace {

template <class T>
bool same_bits(const T* a, const T* b, Eigen::Index count) {
  return std::memcmp(a, b, std::size_t(count) * sizeof(T)) == 0;
}

bool same_pattern(const SparseMatrix& A, const SparseMatrix& B) {
  return A.rows() == B.rows() && A.cols() == B.cols() && A.nonZeros() == B.nonZeros() &&
         same_bits(A.outerIndexPtr(), B.outerIndexPtr(), A.cols() + 1) &&
         same_bits(A.innerIndexPtr(), B.innerIndexPtr(), A.nonZeros());
}

bool all_finite(const SparseMatrix& M) {
  for (int j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it)
      if (!std::isfinite(it.value())) return false;
  return true;
}

// Connected components of the graph of M, by union-find whose roots are the smallest rows.
void find_blocks(const SparseMatrix& M, MassInverse& out) {
  std::vector<int> parent(M.rows());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (int j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) {
      if (it.value() == 0) continue;
      const int a = root(int(it.row())), b = root(j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  out.block_of.resize(parent.size());
  std::vector<int> place;  // of each block, the next free entry of `rows`
  for (int i = 0; i < int(parent.size()); ++i) {
    const int top = root(i);
    if (top == i) place.push_back(0);
    out.block_of[i] = top == i ? int(place.size()) - 1 : out.block_of[top];
    ++place[out.block_of[i]];
  }
  for (int& count : place) {
    const int begin = out.first.back();
    out.first.push_back(begin + count);
    count = begin;
  }
  out.rows.resize(parent.size());
  for (int i = 0; i < int(parent.size()); ++i) out.rows[place[out.block_of[i]]++] = i;
}

// N rows, or any number of them if N is Eigen::Dynamic. Rows and columns are scaled by the diagonal: kg
// beside kg m^2 is not ill-conditioning. False: singular.
template <int N>
bool invert_block(const SparseMatrix& M, const int* rows, int size, double* inverse) {
  using Block = Eigen::Matrix<double, N, N>;
  Block dense(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) dense(i, j) = M.coeff(rows[i], rows[j]);
  const Eigen::Matrix<double, N, 1> scale = dense.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return false;
  dense = scale.asDiagonal() * dense * scale.asDiagonal();
  const Eigen::FullPivLU<Block> lu(dense);
  if (!lu.isInvertible()) return false;
  const Block scaled = lu.inverse();
  Eigen::Map<Block>(inverse, size, size) = scale.asDiagonal() * scaled * scale.asDiagonal();
  return true;
}

bool invert_block(const SparseMatrix& M, const int* rows, int size, double* inverse) {
  switch (size) {
    case 1:  // translations of a body, and rotations about its axes of inertia at rest
      *inverse = 1 / M.coeff(*rows, *rows);
      return std::isfinite(*inverse);
    case 3:
      return invert_block<3>(M, rows, size, inverse);
    default:
      return invert_block<Eigen::Dynamic>(M, rows, size, inverse);
  }
}

// `like` is a factor of the same pattern, or null.
bool invert_block(const SparseMatrix& M, int b, MassInverse& out, const MassFactor* like = nullptr) {
  if (out.size(b) > kLargestMassBlock) {
    out.large[b] = mass_factor(M, std::span(out.rows).subspan(out.first[b], out.size(b)), like);
    return bool(out.large[b]);
  }
  return invert_block(M, out.rows.data() + out.first[b], out.size(b), out.inverse.data() + out.at[b]);
}

}  // namespace

bool same_bits(const SparseMatrix& A, const SparseMatrix& B) {
  return same_pattern(A, B) && same_bits(A.valuePtr(), B.valuePtr(), A.nonZeros());
}

VecX MassInverse::operator*(const VecX& x) const {
  VecX y(x.size());
  for (int b = 0; b < count(); ++b) {
    const int *of = rows.data() + first[b], n = size(b);
    if (const MassFactor* f = factor(b)) {
      const std::span some(of, std::size_t(n));
      y(some) = solve(*f, x(some));
      continue;
    }
    const double* inv = inverse.data() + at[b];
    for (int i = 0; i < n; ++i) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += inv[i + n * j] * x[of[j]];
      y[of[i]] = sum;
    }
  }
  return y;
}

SparseMatrix MassInverse::operator*(const SparseMatrix& X) const {
  if (std::size_t(count()) == block_of.size())  // all blocks of one row: balls, and cubes that do not turn
    return Eigen::Map<const VecX>(inverse.data(), X.rows()).asDiagonal() * X;
  SparseMatrix Y(X.rows(), X.cols());
  Y.reserve(2 * X.nonZeros());
  std::vector<int> touched;                    // blocks of more than one row
  std::vector<std::pair<int, double>> column;  // row, value
  VecX x = VecX::Zero(X.rows());
  for (int j = 0; j < X.outerSize(); ++j) {
    touched.clear();
    column.clear();
    for (SparseMatrix::InnerIterator it(X, j); it; ++it) {
      const int b = block_of[it.row()];
      if (size(b) == 1) {
        column.emplace_back(it.row(), inverse[at[b]] * it.value());
        continue;
      }
      if (touched.empty() || touched.back() != b) touched.push_back(b);
      x[it.row()] = it.value();
    }
    if (!std::ranges::is_sorted(touched)) {  // blocks that lie among each other
      std::ranges::sort(touched);
      touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    }
    for (const int b : touched) {
      const int *of = rows.data() + first[b], n = size(b);
      if (const MassFactor* f = factor(b)) {
        const VecX y = solve(*f, x(std::span(of, std::size_t(n))));
        for (int i = 0; i < n; ++i)
          if (y[i] != 0) column.emplace_back(of[i], y[i]);
        for (int i = 0; i < n; ++i) x[of[i]] = 0;
        continue;
      }
      const double* inv = inverse.data() + at[b];
      for (int i = 0; i < n; ++i) {
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += inv[i + n * k] * x[of[k]];
        column.emplace_back(of[i], sum);
      }
      for (int i = 0; i < n; ++i) x[of[i]] = 0;
    }
    if (!std::ranges::is_sorted(column)) std::ranges::sort(column);
    Y.startVec(j);
    for (const auto& [row, value] : column) Y.insertBackByOuterInner(j, row) = value;
  }
  Y.finalize();
  return Y;
}

MassInverse inverse_part(const MassInverse& inverse, const std::vector<int>& some) {
  if (some.size() == inverse.block_of.size()) return inverse;
  MassInverse out;
  out.block_of.resize(some.size());
  out.rows.reserve(some.size());
  out.first.reserve(some.size() + 1);
  out.at.reserve(some.size());
  out.inverse.reserve(some.size());
  const auto place = [&](int row) { return int(std::ranges::lower_bound(some, row) - some.begin()); };
  for (const int row : some) {
    const int b = inverse.block_of[row], n = inverse.size(b);
    const int* rows = inverse.rows.data() + inverse.first[b];
    if (*rows != row) continue;  // blocks come with their first row
    for (int i = 0; i < n; ++i) {
      out.rows.push_back(place(rows[i]));
      out.block_of[out.rows.back()] = out.count();
    }
    out.at.push_back(out.inverse.size());
    out.first.push_back(int(out.rows.size()));
    if (inverse.factor(b)) {
      out.large.resize(out.at.size());
      out.large.back() = inverse.large[b];
      continue;
    }
    const double* entries = inverse.inverse.data() + inverse.at[b];
    out.inverse.insert(out.inverse.end(), entries, entries + n * n);
  }
  if (!out.large.empty()) out.large.resize(out.at.size());
  return out;
}

std::optional<MassInverse> invert_mass(const SparseMatrix& M) {
  if (!all_finite(M)) return std::nullopt;
  MassInverse out;
  find_blocks(M, out);
  const int blocks = int(out.first.size()) - 1;
  std::size_t entries = 0;
  for (int b = 0; b < blocks; ++b) {
    const int n = out.size(b);
    out.at.push_back(entries);
    if (n > kLargestMassBlock)
      out.large.resize(std::size_t(blocks));
    else
      entries += std::size_t(n) * std::size_t(n);
  }
  out.inverse.resize(entries);
  for (int b = 0; b < blocks; ++b)
    if (!invert_block(M, b, out)) return std::nullopt;
  return out;
}

std::optional<MassInverse> invert_mass(const SparseMatrix& M, const SparseMatrix& last_M,
                                       const MassInverse& last) {
  if (!same_pattern(M, last_M)) return invert_mass(M);
  std::vector<int> changed;  // blocks; M's columns belong to one block each
  for (int j = 0; j < M.outerSize(); ++j) {
    const int begin = M.outerIndexPtr()[j], end = M.outerIndexPtr()[j + 1];
    const double *now = M.valuePtr(), *before = last_M.valuePtr();
    if (same_bits(now + begin, before + begin, end - begin)) continue;
    for (int k = begin; k < end; ++k)  // a coupling that comes or goes makes other blocks
      if (!std::isfinite(now[k]) || (now[k] == 0) != (before[k] == 0)) return invert_mass(M);
    if (changed.empty() || changed.back() != last.block_of[j]) changed.push_back(last.block_of[j]);
  }
  std::ranges::sort(changed);
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  MassInverse out = last;
  for (const int b : changed)
    if (!invert_block(M, b, out, last.factor(b))) return std::nullopt;
  return out;
}

}  // namespace aussois
