// SPDX-License-Identifier: Apache-2.0
#include "nsgs/friction_problem.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "geometry/check.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {

namespace {

void validate_friction(const std::vector<double>& mu) {
  for (std::size_t i = 0; i < mu.size(); ++i)
    if (!(std::isfinite(mu[i]) && mu[i] >= 0))
      require_field(false, ("mu[" + std::to_string(i) + "]").c_str(), mu[i], "be finite and >= 0");
}

}  // namespace

void validate(const FrictionProblem& problem) {
  const Eigen::Index n = problem.f.size(), rows = 3 * Eigen::Index(problem.contact_count());
  require_field(problem.M.rows() == n, "FrictionProblem::M.rows()", problem.M.rows(), "equal f.size()");
  require_field(problem.M.cols() == n, "FrictionProblem::M.cols()", problem.M.cols(), "equal f.size()");
  require_field(problem.w.size() == rows, "FrictionProblem::w.size()", problem.w.size(), "equal 3 mu.size()");
  require_field(problem.H.cols() == rows, "FrictionProblem::H.cols()", problem.H.cols(), "equal 3 mu.size()");
  require_field(rows == 0 || problem.H.rows() == n, "FrictionProblem::H.rows()", problem.H.rows(),
                "equal f.size()");
  validate_friction(problem.mu);
}

void validate(const LocalProblem& problem) {
  const BlockMatrix& W = problem.W;
  const int rows = problem.contact_count();
  require_field(W.rows() == rows, "LocalProblem::W.rows()", W.rows(), "equal mu.size()");
  require_field(problem.q.size() == 3 * rows, "LocalProblem::q.size()", problem.q.size(),
                "equal 3 mu.size()");
  require_field(W.column.size() == W.block.size(), "LocalProblem::W.column.size()", W.column.size(),
                "equal W.block.size()");
  require_field(rows == 0 || (W.begin.front() == 0 && W.begin.back() == int(W.column.size())),
                "LocalProblem::W.begin", rows == 0 ? 0 : W.begin.back(), "run from 0 to W.column.size()");
  for (int i = 0; i < rows; ++i) {
    const int first = W.begin[std::size_t(i)], last = W.begin[std::size_t(i) + 1];
    require_field(first <= last && first >= 0 && last <= int(W.column.size()), "LocalProblem::W.begin", last,
                  "ascend within W.column");
    bool has_diagonal = false;
    for (int k = first; k < last; ++k) {
      const int column = W.column[std::size_t(k)];
      require_field(column >= 0 && column < rows && (k == first || W.column[std::size_t(k) - 1] < column),
                    "LocalProblem::W.column", column, "ascend within a row and lie in [0, rows)");
      has_diagonal = has_diagonal || column == i;
    }
    require_field(has_diagonal, "LocalProblem::W row", i, "store its diagonal block");
  }
  validate_friction(problem.mu);
}

const Mat3& BlockMatrix::diagonal(int i) const {
  const auto first = column.begin() + begin[std::size_t(i)],
             last = column.begin() + begin[std::size_t(i) + 1];
  return block[std::size_t(std::lower_bound(first, last, i) - column.begin())];
}

Vec3 BlockMatrix::row_times(int i, const VecX& r) const {
  Vec3 sum = Vec3::Zero();
  for (int k = begin[std::size_t(i)]; k < begin[std::size_t(i) + 1]; ++k)
    sum += block[std::size_t(k)] * r.segment<3>(3 * Eigen::Index(column[std::size_t(k)]));
  return sum;
}

VecX BlockMatrix::operator*(const VecX& r) const {
  VecX y(r.size());
  for (int i = 0; i < rows(); ++i) y.segment<3>(3 * i) = row_times(i, r);
  return y;
}

BlockMatrix block_matrix(const SparseMatrix& A) {
  const int rows = int(A.rows() / 3);
  std::vector<std::map<int, Mat3>> row(std::size_t(rows), std::map<int, Mat3>{});
  for (int i = 0; i < rows; ++i) row[std::size_t(i)].emplace(i, Mat3::Zero());
  for (int j = 0; j < A.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      const int i = int(it.row());
      const auto place = row[std::size_t(i / 3)].try_emplace(j / 3, Mat3::Zero()).first;
      place->second(i % 3, j % 3) = it.value();
    }
  BlockMatrix W;
  W.begin.push_back(0);
  for (const auto& blocks : row) {
    for (const auto& [column, block] : blocks) {
      W.column.push_back(column);
      W.block.push_back(block);
    }
    W.begin.push_back(int(W.column.size()));
  }
  return W;
}

SparseMatrix sparse_matrix(const BlockMatrix& W) {
  std::vector<Triplet> entries;
  for (int i = 0; i < W.rows(); ++i)
    for (int k = W.begin[std::size_t(i)]; k < W.begin[std::size_t(i) + 1]; ++k)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          entries.emplace_back(3 * i + a, 3 * W.column[std::size_t(k)] + b, W.block[std::size_t(k)](a, b));
  SparseMatrix A(3 * W.rows(), 3 * W.rows());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

LocalProblem condense(const FrictionProblem& problem) {
  validate(problem);
  const std::optional<MassInverse> inverse = invert_mass(problem.M);
  if (!inverse) throw std::runtime_error("condense: FrictionProblem::M is singular or not finite");
  LocalProblem local;
  local.mu = problem.mu;
  if (problem.contact_count() == 0) {
    local.q = VecX(0);
    return local;
  }
  const SparseMatrix Ht = problem.H.transpose();
  local.W = block_matrix(Ht * (*inverse * problem.H));
  local.q = Ht * (*inverse * problem.f) + problem.w;
  return local;
}

}  // namespace aussois
