// SPDX-License-Identifier: Apache-2.0
#include "mechanics/force_matrix.hpp"

#include <algorithm>
#include <span>

#include "geometry/check.hpp"
#include "mechanics/layout.hpp"

namespace aussois {
namespace {

// A block column of a matrix, with the first row of the problem that it stands for.
struct FreeColumn {
  int row = 0;
  const ForceMatrix* of = nullptr;
  int column = 0;
};

std::vector<FreeColumn> free_columns(const std::vector<ForceMatrix>& matrices, const Layout& dofs) {
  std::vector<FreeColumn> out;
  for (const ForceMatrix& m : matrices)
    for (int j = 0; j < std::ssize(m.pattern->entry); ++j)
      if (const int row = any_row_of(dofs, m.first + m.pattern->entry[j]); row >= 0)
        out.push_back({row, &m, j});
  std::ranges::stable_sort(out, {}, &FreeColumn::row);  // of several laws
  return out;
}

bool is_held(const Layout& dofs, int row) {
  return row >= dofs.coordinates && dofs.held[row - dofs.coordinates];
}

std::span<const int> rows_of(const BlockPattern& p, int column) {
  const auto begin = std::size_t(p.begin[column]);
  return std::span(p.row).subspan(begin, std::size_t(p.begin[std::size_t(column) + 1]) - begin);
}

// The rows of the problem that begin the blocks of columns at one place, ascending.
std::vector<int> first_rows_of(std::span<const FreeColumn> same, const Layout& dofs) {
  std::vector<int> out;
  for (const FreeColumn& c : same)
    for (const int k : rows_of(*c.of->pattern, c.column))
      if (const int row = any_row_of(dofs, c.of->first + c.of->pattern->entry[k]); row >= 0)
        out.push_back(row);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

std::shared_ptr<const BlockPattern> block_pattern(int size, std::vector<int> entry,
                                                  const std::vector<std::vector<int>>& elements) {
  auto out = std::make_shared<BlockPattern>(BlockPattern{.size = size, .entry = std::move(entry)});
  std::vector<std::vector<int>> rows(out->entry.size());
  for (const std::vector<int>& element : elements)
    for (const int j : element) rows[j].insert(rows[j].end(), element.begin(), element.end());
  for (std::vector<int>& of : rows) {
    std::ranges::sort(of);
    of.erase(std::unique(of.begin(), of.end()), of.end());
    out->row.insert(out->row.end(), of.begin(), of.end());
    out->begin.push_back(int(out->row.size()));
  }
  return out;
}

int block_at(const BlockPattern& pattern, int row, int column) {
  const std::span<const int> rows = rows_of(pattern, column);
  return pattern.begin[column] + int(std::ranges::lower_bound(rows, row) - rows.begin());
}

void validate(const ForceMatrix& matrix, int velocities) {
  require(matrix.pattern != nullptr, "ForceMatrix::pattern must not be null");
  const BlockPattern& p = *matrix.pattern;
  const std::string size = std::to_string(p.values());
  require_field(matrix.K.size() == p.values(), "ForceMatrix::K.size()", matrix.K.size(),
                ("be " + size + ", as of its pattern").c_str());
  require_field(matrix.C.empty() || matrix.C.size() == p.values(), "ForceMatrix::C.size()", matrix.C.size(),
                ("be 0 or " + size + ", as of its pattern").c_str());
  if (p.entry.empty()) return;
  require_field(matrix.first + p.entry.front() >= 0, "first entry of ForceMatrix",
                matrix.first + p.entry.front(), "be at least 0");
  require_field(matrix.first + p.entry.back() + p.size <= velocities, "last entry of ForceMatrix",
                matrix.first + p.entry.back() + p.size - 1,
                ("be below " + std::to_string(velocities)).c_str());
}

VecX force_change(const std::vector<ForceMatrix>& matrices, const VecX& dq, const VecX& dv) {
  VecX out = VecX::Zero(dq.size());
  const auto add = [&](const ForceMatrix& m, const std::vector<double>& values, const VecX& x) {
    const BlockPattern& p = *m.pattern;
    const double* value = values.data();
    for (std::size_t j = 0; j < p.entry.size(); ++j)
      for (int b = 0; b < p.size; ++b) {
        const double x_j = x[m.first + p.entry[j] + b];
        for (const int k : rows_of(p, int(j)))
          for (int a = 0; a < p.size; ++a) out[m.first + p.entry[k] + a] += *value++ * x_j;
      }
  };
  for (const ForceMatrix& m : matrices) {
    add(m, m.K, dq);
    if (!m.C.empty()) add(m, m.C, dv);
  }
  return out;
}

SparseMatrix free_matrix(const std::vector<ForceMatrix>& matrices, double of_K, double of_C,
                         const Layout& dofs) {
  const std::vector<FreeColumn> columns = free_columns(matrices, dofs);
  std::size_t most = 0;
  for (const FreeColumn& c : columns)
    most += rows_of(*c.of->pattern, c.column).size() * std::size_t(c.of->pattern->size * c.of->pattern->size);
  SparseMatrix out(dofs.rows, dofs.rows);
  out.resizeNonZeros(Eigen::Index(most));
  int *outer = out.outerIndexPtr(), *inner = out.innerIndexPtr(), column = 0, count = 0;
  double* const value = out.valuePtr();
  for (std::size_t from = 0, to = 0; from < columns.size(); from = to) {
    while (to < columns.size() && columns[to].row == columns[from].row) ++to;
    const std::span same = std::span(columns).subspan(from, to - from);
    const int size = same.front().of->pattern->size, row = same.front().row;
    const std::vector<int> rows = first_rows_of(same, dofs);
    const int height = size * int(rows.size());
    while (column < row) outer[++column] = count;
    for (int b = 0; b < size; ++b) {
      for (int i = 0; i < height; ++i) {
        inner[count + b * height + i] = rows[std::size_t(i / size)] + i % size;
        value[count + b * height + i] = 0;
      }
      outer[++column] = count + (b + 1) * height;
    }
    for (const FreeColumn& c : same) {
      const BlockPattern& p = *c.of->pattern;
      const std::span<const int> own = rows_of(p, c.column);
      const std::size_t corner = std::size_t(size * size) * std::size_t(p.begin[c.column]);
      for (std::size_t k = 0; k < own.size(); ++k) {
        const int first = any_row_of(dofs, c.of->first + p.entry[own[k]]);
        if (first < 0) continue;
        const int place = size * int(std::ranges::lower_bound(rows, first) - rows.begin());
        for (int b = 0; b < size; ++b)
          for (int a = 0; a < size; ++a) {
            const std::size_t i =
                corner + std::size_t(size) * (std::size_t(b) * own.size() + k) + std::size_t(a);
            double& sum = value[count + b * height + place + a];
            sum += of_K * c.of->K[i];
            if (of_C != 0 && !c.of->C.empty()) sum += of_C * c.of->C[i];
          }
      }
    }
    for (int b = 0; b < size && !dofs.held.empty(); ++b)  // what is held keeps its speed
      for (int i = count + b * height; i < count + (b + 1) * height; ++i)
        if (is_held(dofs, inner[i]) || is_held(dofs, row + b)) value[i] = 0;
    count += size * height;
  }
  while (column < dofs.rows) outer[++column] = count;
  out.resizeNonZeros(count);
  return out;
}

}  // namespace aussois
