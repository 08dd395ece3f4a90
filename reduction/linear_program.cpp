// SPDX-License-Identifier: Apache-2.0
#include "reduction/linear_program.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace aussois {
namespace {

constexpr double kZero = 1e-10;  // of numbers of size 1
constexpr int kFastPivots = 50;  // by the steepest cost; a program of six rows needs some ten
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

// Columns beyond those of G are the signed unit vectors of phase one.
class Simplex {
 public:
  Simplex(const Generators& G, const ShortVector& g) : G_(G), g_(g), n_(int(G.cols())), rows_(int(G.rows())) {
    inverse_ = Square::Zero(rows_, rows_);
    for (int i = 0; i < rows_; ++i) {
      inverse_(i, i) = g[i] < 0 ? -1 : 1;
      basis_.push_back(n_ + i);
    }
    x_ = inverse_ * g;
  }

  Combination cheapest(const VecX& cost) {
    Combination out{.dual = minimise(VecX::Zero(n_), 1)};
    double infeasibility = 0;
    for (int i = 0; i < rows_; ++i)
      if (basis_[i] >= n_) infeasibility += x_[i];
    if (infeasibility > kZero * (1 + g_.lpNorm<1>())) return out;
    out.exists = true;
    out.cost = 0;
    out.dual = minimise(cost, 0);
    std::vector<std::pair<int, double>> used;
    for (int i = 0; i < rows_; ++i)
      if (basis_[i] < n_ && x_[i] > kZero) used.emplace_back(basis_[i], x_[i]);
    std::sort(used.begin(), used.end());
    for (const auto& [column, weight] : used) {
      out.column.push_back(column);
      out.weight.push_back(weight);
      out.cost += weight * cost[column];
    }
    return out;
  }

 private:
  // With `artificial` the cost of the unit vectors, which never come back; at cost 0 they are held at zero.
  ShortVector minimise(const VecX& cost, double artificial) {
    for (int pivots = 0;; ++pivots) {
      ShortVector c(rows_);
      for (int i = 0; i < rows_; ++i) c[i] = basis_[i] < n_ ? cost[basis_[i]] : artificial;
      ShortVector y = inverse_.transpose() * c;
      int enters = -1;
      double least = -kZero;
      for (int j = 0; j < n_; ++j) {
        const double reduced = cost[j] - y.dot(G_.col(j));
        if (reduced >= least - (enters < 0 ? 0 : kZero) ||
            std::find(basis_.begin(), basis_.end(), j) != basis_.end())
          continue;
        enters = j;
        if (pivots >= kFastPivots) break;  // Bland: the first
        least = reduced;
      }
      if (enters < 0) return y;
      const ShortVector d = inverse_ * G_.col(enters);
      const int leaves = row_that_leaves(d, artificial, pivots >= kFastPivots);
      if (leaves < 0) return y;  // cannot be with costs >= 0, but for rounding
      pivot(leaves, enters, d);
    }
  }

  // The row whose weight first comes to zero: of those that do together the one with the largest pivot, so
  // that a degenerate vertex does not spoil the inverse, or by Bland the first column.
  int row_that_leaves(const ShortVector& d, double artificial, bool bland) const {
    const auto held = [&](int i) { return artificial == 0 && basis_[i] >= n_; };
    const auto ratio = [&](int i) {
      if (held(i)) return std::abs(d[i]) <= kZero ? kInf : 0;
      return d[i] <= kZero ? kInf : std::max(x_[i], 0.0) / d[i];
    };
    double step = kInf;
    for (int i = 0; i < rows_; ++i) step = std::min(step, ratio(i));
    if (step == kInf) return -1;
    int leaves = -1;
    for (int i = 0; i < rows_; ++i) {
      if (ratio(i) > step + (bland ? 0 : kZero)) continue;
      if (leaves < 0 || (bland ? basis_[i] < basis_[leaves] : std::abs(d[i]) > std::abs(d[leaves])))
        leaves = i;
    }
    return leaves;
  }

  void pivot(int leaves, int enters, const ShortVector& d) {
    basis_[leaves] = enters;
    const Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 6> row =
        inverse_.row(leaves) / d[leaves];
    inverse_ -= d * row;
    inverse_.row(leaves) = row;
    x_ = inverse_ * g_;
  }

  const Generators& G_;
  const ShortVector& g_;
  int n_ = 0, rows_ = 0;
  std::vector<int> basis_{};  // by row
  Square inverse_{};          // of the basic columns
  ShortVector x_{};           // their weights
};

}  // namespace

Combination cheapest_combination(const Generators& G, const ShortVector& g, const VecX& cost) {
  return Simplex(G, g).cheapest(cost);
}

}  // namespace aussois
