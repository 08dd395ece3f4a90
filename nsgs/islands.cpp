// SPDX-License-Identifier: Apache-2.0
#include "nsgs/islands.hpp"

#include <algorithm>
#include <numeric>

namespace aussois {

namespace {

// Union-find whose roots are the smallest members.
class Groups {
 public:
  explicit Groups(Eigen::Index count) : parent_(std::size_t(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The root of both.
  int join(int a, int b) {
    const int p = root(a), q = root(b), top = std::min(p, q);
    parent_[p] = parent_[q] = top;
    return top;
  }
  /// Joins all rows that a column of A touches with each other; their root, or -1 of an empty column.
  int join_column(const SparseMatrix& A, Eigen::Index column) {
    int top = -1;
    for (SparseMatrix::InnerIterator it(A, column); it; ++it) {
      if (parent_[it.row()] == top) continue;  // as most are: columns resemble each other
      if (it.value() == 0) continue;           // NaN is a coupling
      top = top < 0 ? root(int(it.row())) : join(top, int(it.row()));
    }
    return top;
  }

 private:
  std::vector<int> parent_;
};

// Rows and columns of A, ascending lists; `place` is scratch of A.rows() entries, all -1, and left so.
SparseMatrix sub_matrix(const SparseMatrix& A, const std::vector<int>& rows, const std::vector<int>& columns,
                        std::vector<int>& place) {
  for (std::size_t i = 0; i < rows.size(); ++i) place[rows[i]] = int(i);
  SparseMatrix out(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  Eigen::Index entries = 0;
  for (const int j : columns) entries += A.outerIndexPtr()[j + 1] - A.outerIndexPtr()[j];
  out.reserve(entries);
  for (std::size_t j = 0; j < columns.size(); ++j) {
    out.startVec(Eigen::Index(j));
    for (SparseMatrix::InnerIterator it(A, columns[j]); it; ++it)
      if (const int i = place[it.row()]; i >= 0) out.insertBackByOuterInner(Eigen::Index(j), i) = it.value();
  }
  out.finalize();
  for (const int row : rows) place[row] = -1;
  return out;
}

VecX sub_vector(const VecX& x, const std::vector<int>& rows) {
  return x.size() == 0 ? VecX() : VecX(x(rows));
}

std::vector<Law> sub_laws(const std::vector<Law>& laws, const std::vector<int>& blocks) {
  std::vector<Law> out;
  out.reserve(blocks.size());
  for (const int c : blocks) out.push_back(laws[c]);
  return out;
}

}  // namespace

std::vector<Island> islands(const FrictionProblem& problem, const std::vector<char>& left_out) {
  const std::vector<int> first = first_rows(problem.laws);
  const auto is_left_out = [&](std::size_t c) { return !left_out.empty() && left_out[c]; };
  Groups groups(problem.f.size());
  for (Eigen::Index j = 0; j < problem.M.cols(); ++j)
    if (const int row = groups.join_column(problem.M, j); row >= 0) groups.join(row, int(j));
  std::vector<int> dof_of_joint, dof_of_block;
  for (Eigen::Index j = 0; j < problem.G.cols(); ++j)
    dof_of_joint.push_back(groups.join_column(problem.G, j));
  for (std::size_t c = 0; c < problem.laws.size(); ++c) {
    int dof = -1;
    for (int j = first[c]; j < first[c + 1] && !is_left_out(c); ++j)
      if (const int row = groups.join_column(problem.H, j); row >= 0) {
        dof = dof < 0 ? row : groups.join(dof, row);
      }
    dof_of_block.push_back(dof);
  }
  std::vector<int> island_of(std::size_t(problem.f.size()), -1);
  std::vector<Island> out;
  for (const int dof : dof_of_block)
    if (dof >= 0) island_of[groups.root(dof)] = 0;
  Island free;
  for (int i = 0; i < int(problem.f.size()); ++i) {
    const auto root = std::size_t(groups.root(i));
    if (island_of[root] < 0) {
      free.dofs.push_back(i);
      continue;
    }
    if (int(root) == i) {  // comes before the others of its group
      island_of[root] = int(out.size());
      out.emplace_back();
    }
    out[island_of[root]].dofs.push_back(i);
  }
  for (std::size_t c = 0; c < problem.laws.size(); ++c) {
    if (is_left_out(c)) continue;
    if (dof_of_block[c] < 0) out.emplace_back();  // nothing moves it: the solver reports this trouble
    Island& island = dof_of_block[c] < 0 ? out.back() : out[island_of[groups.root(dof_of_block[c])]];
    island.blocks.push_back(int(c));
    for (int j = first[c]; j < first[c + 1]; ++j) island.rows.push_back(j);
  }
  for (std::size_t j = 0; j < dof_of_joint.size(); ++j)
    if (dof_of_joint[j] >= 0) {
      const int i = island_of[groups.root(dof_of_joint[j])];
      (i < 0 ? free : out[i]).joints.push_back(int(j));
    }
  if (!free.dofs.empty()) out.push_back(std::move(free));
  return out;
}

std::vector<int> leaders(const LocalProblem& problem) {
  std::vector<int> block_of;
  block_of.reserve(problem.q.size());
  for (std::size_t c = 0; c < problem.laws.size(); ++c)
    block_of.insert(block_of.end(), std::size_t(problem.laws[c].rows), int(c));
  Groups groups(Eigen::Index(problem.laws.size()));
  for (Eigen::Index j = 0; j < problem.W.cols(); ++j) {
    int last = block_of[j];
    for (SparseMatrix::InnerIterator it(problem.W, j); it; ++it) {
      const int c = block_of[it.row()];
      if (c == last || it.value() == 0) continue;  // NaN is a coupling
      groups.join(last, c);
      last = c;
    }
  }
  std::vector<int> out;
  out.reserve(problem.laws.size());
  for (std::size_t c = 0; c < problem.laws.size(); ++c) out.push_back(groups.root(int(c)));
  return out;
}

std::vector<Island> islands(const LocalProblem& problem, const std::vector<int>& leader,
                            const std::vector<char>& left_out) {
  std::vector<int> island_of(problem.laws.size(), -1);
  std::vector<Island> out;
  int row = 0;
  for (std::size_t c = 0; c < problem.laws.size(); ++c) {
    const int rows = problem.laws[c].rows;
    if (left_out.empty() || !left_out[c]) {
      int& place = island_of[leader[c]];
      if (place < 0) {
        place = int(out.size());
        out.emplace_back();
      }
      Island& island = out[place];
      island.blocks.push_back(int(c));
      for (int j = row; j < row + rows; ++j) island.rows.push_back(j);
    }
    row += rows;
  }
  return out;
}

bool is_whole(const FrictionProblem& problem, const Island& island) {
  return Eigen::Index(island.dofs.size()) == problem.f.size() &&
         island.blocks.size() == problem.laws.size() &&
         Eigen::Index(island.joints.size()) == problem.G.cols();
}

bool is_whole(const LocalProblem& problem, const Island& island) {
  return island.blocks.size() == problem.laws.size();
}

FrictionProblem island_problem(const FrictionProblem& problem, const Island& island,
                               std::vector<int>& place) {
  place.resize(std::size_t(problem.f.size()), -1);
  return {.M = sub_matrix(problem.M, island.dofs, island.dofs, place),
          .H = sub_matrix(problem.H, island.dofs, island.rows, place),
          .f = sub_vector(problem.f, island.dofs),
          .w = sub_vector(problem.w, island.rows),
          .laws = sub_laws(problem.laws, island.blocks),
          .G = sub_matrix(problem.G, island.joints.empty() ? std::vector<int>{} : island.dofs, island.joints,
                          place),
          .b = sub_vector(problem.b, island.joints),
          .R = sub_vector(problem.R, island.rows)};
}

LocalProblem island_problem(const LocalProblem& problem, const Island& island, std::vector<int>& place) {
  place.resize(std::size_t(problem.q.size()), -1);
  return {.W = sub_matrix(problem.W, island.rows, island.rows, place),
          .q = sub_vector(problem.q, island.rows),
          .laws = sub_laws(problem.laws, island.blocks)};
}

}  // namespace aussois
