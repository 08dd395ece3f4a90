// SPDX-License-Identifier: Apache-2.0
#include "nsgs/block_solver.hpp"
#include "nsgs/delassus.hpp"
#include "nsgs/factorised.hpp"
#include "nsgs/sparse_lu.hpp"

namespace aussois {

namespace {

// Blocks in compressed rows, or in compressed columns; ascending, the diagonal always there.
template <int R>
struct Blocks {
  std::vector<int> begin{}, other{};
  std::vector<RowBlock<R>> block{};
};

// Rows of blocks of the scaled W. Columns are visited in ascending order, so rows come out sorted.
template <int R>
Blocks<R> block_rows(const SparseMatrix& W, const Scaling& scaled, const std::vector<int>& first) {
  const int count = int(scaled.laws.size());
  std::vector<int> block_of(W.rows());
  for (int c = 0; c < count; ++c)
    for (int i = first[c]; i < first[std::size_t(c) + 1]; ++i) block_of[i] = c;
  std::vector<int> seen(std::size_t(count), -1);  // per block row: the last column that met it
  Blocks<R> out;
  out.begin.assign(std::size_t(count) + 1, 0);
  for (int c = 0; c < count; ++c) {
    seen[c] = c;
    ++out.begin[std::size_t(c) + 1];
    for (int j = first[c]; j < first[std::size_t(c) + 1]; ++j)
      for (SparseMatrix::InnerIterator it(W, j); it; ++it) {
        const auto i = std::size_t(block_of[it.row()]);
        if (seen[i] != c) ++out.begin[i + 1];
        seen[i] = c;
      }
  }
  for (std::size_t i = 0; i < std::size_t(count); ++i) out.begin[i + 1] += out.begin[i];
  out.other.resize(out.begin.back());
  out.block.resize(out.other.size());
  std::vector<int> end(out.begin.begin(), out.begin.end() - 1);  // of what each row has by now
  const auto at = [&](int i, int c) -> RowBlock<R>& {            // made when first needed
    int& next = end[i];
    if (next == out.begin[i] || out.other[std::size_t(next) - 1] != c) {
      out.other[next] = c;
      out.block[next++] = RowBlock<R>::Zero(scaled.laws[i].rows, scaled.laws[c].rows);
    }
    return out.block[std::size_t(next) - 1];
  };
  for (int c = 0; c < count; ++c) {
    at(c, c);
    for (int j = first[c]; j < first[std::size_t(c) + 1]; ++j)
      for (SparseMatrix::InnerIterator it(W, j); it; ++it) {
        const int i = block_of[it.row()];
        at(i, c)(it.row() - first[i], j - first[c]) = it.value() * scaled.s[it.row()] * scaled.s[j];
      }
  }
  return out;
}

// The same blocks by columns, those of each column in the order given.
template <int R>
Blocks<R> block_columns(const Blocks<R>& rows, const std::vector<int>& order) {
  Blocks<R> out;
  out.begin.assign(rows.begin.size(), 0);
  for (const int c : rows.other) ++out.begin[std::size_t(c) + 1];
  for (std::size_t i = 1; i < out.begin.size(); ++i) out.begin[i] += out.begin[i - 1];
  out.other.resize(rows.other.size());
  out.block.resize(rows.block.size());
  std::vector<int> next(out.begin.begin(), out.begin.end() - 1);
  for (const int i : order)
    for (int k = rows.begin[i]; k < rows.begin[std::size_t(i) + 1]; ++k) {
      const auto place = std::size_t(next[rows.other[k]]++);
      out.other[place] = i;
      out.block[place] = rows.block[k];
    }
  return out;
}

template <int R>
class LocalDelassus final : public Delassus {
 public:
  explicit LocalDelassus(const LocalProblem& problem) {
    first = first_rows(problem.laws);
    scaled = scaling(problem.W.diagonal(), problem.q, problem.laws);
    if (!scaled.finite) return;
    rows_ = block_rows<R>(problem.W, scaled, first);
    for (int c = 0; c < count(); ++c) {
      auto k = std::size_t(rows_.begin[c]);
      while (rows_.other[k] != c) ++k;
      own_.push_back(k);
      scaled.finite = scaled.finite && rows_.block[k].allFinite();
    }
    diagonal_.resize(own_.size());
  }

  VecX velocity(const VecX& r) override {
    VecX u(r.size());
    for (int c = 0; c < count(); ++c) u.segment<R>(at(c), rows(c)) = velocity(c, r);
    return u;
  }

  BlockChange relax(int c, VecX& r, const SweepOptions& options) override {
    const Law& law = scaled.laws[c];
    const Rows<R> r_old = r.segment<R>(at(c), rows(c)), u = velocity(c, r);
    if (has_normal(law) && u[0] >= 0 && r_old[0] == 0) return {};  // stays open (NSGS-6)
    const Block<R>& block = prepared(c);
    const BlockSolution<R> found = solve_block(block, u - block.W * r_old, law, r_old, options.local);
    const Rows<R> dr = options.relaxation * (found.r - r_old);
    r.segment<R>(at(c), rows(c)) += dr;
    return {dr.squaredNorm(), !found.solved, found.fail_safe};
  }

  std::vector<int> colours() const override {
    std::vector<std::vector<int>> feels(scaled.laws.size());  // both ways, where W is not symmetric
    for (int c = 0; c < count(); ++c)
      for (int k = rows_.begin[c]; k < rows_.begin[std::size_t(c) + 1]; ++k) {
        const int d = rows_.other[k];
        if (d < c) feels[c].push_back(d);
        if (d > c) feels[d].push_back(c);
      }
    std::vector<int> colour(scaled.laws.size()), last(colour.size() + 1, -1);
    for (std::size_t c = 0; c < colour.size(); ++c) {
      for (const int d : feels[c]) last[colour[d]] = int(c);
      while (last[colour[c]] == int(c)) ++colour[c];
    }
    return colour;
  }

  using Delassus::sweep;
  double sweep(VecX& r, const BlockRule& rule) override {
    double change = 0;
    for (int c = 0; c < count(); ++c) {
      const AnyRows r_old = r.segment(at(c), rows(c)), r_new = rule(c, velocity(c, r), r_old);
      r.segment(at(c), rows(c)) = r_new;
      change += (r_new - r_old).squaredNorm();
    }
    return std::sqrt(change);
  }

  AnyBlock block(int c) const override { return rows_.block[own_[c]]; }
  SparseMatrix matrix() const override {
    std::vector<Triplet> entries;
    for (int c = 0; c < count(); ++c)
      for (int k = rows_.begin[c]; k < rows_.begin[std::size_t(c) + 1]; ++k) {
        const int d = rows_.other[k];
        for (int i = 0; i < rows(c); ++i)
          for (int j = 0; j < rows(d); ++j) entries.emplace_back(at(c) + i, at(d) + j, rows_.block[k](i, j));
      }
    SparseMatrix W(scaled.q.size(), scaled.q.size());
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
  }
  LinearSolve shifted_inverse(double shift) const override {
    SparseMatrix W = matrix();
    for (Eigen::Index i = 0; i < W.rows(); ++i) W.coeffRef(i, i) += shift;
    return factorised(W);
  }

  Eigen::Index unknowns() const override { return scaled.q.size(); }
  VecX A(const VecX& d) const override { return d; }
  VecX C(const VecX& d) const override { return d; }
  VecX B(const VecX& dr) const override {
    VecX y(dr.size());
    for (int c = 0; c < count(); ++c) y.segment<R>(at(c), rows(c)) = times(c, dr);
    return y;
  }
  double size(const VecX& row) const override { return row.norm(); }
  double newton_cost(const VecX& r) override {
    double sweep = 80.0 * count();  // the blocks' own solves
    for (const RowBlock<R>& block : rows_.block) sweep += 2 * double(block.size());
    CompressedColumns J =
        newton_matrix(closed_blocks([&](int c) { return !r.segment<R>(at(c), rows(c)).isZero(0); }),
                      [&](int c) { return RowBlock<R>::Identity(rows(c), rows(c)); });
    return factor_cost(J) / sweep + 2;
  }

  // Blocks with D = 0 do not act on the others: they are left out of the system and follow from it.
  NewtonSolve newton_inverse(std::vector<AnyBlock> D) override {
    std::vector<int> place = closed_blocks([&](int c) { return !D[c].isZero(0); });
    LinearSolve solve = inverse_of(newton_matrix(place, [&](int c) { return RowBlock<R>(D[c]); }));
    if (!solve) return {};
    return [this, D = std::move(D), place = std::move(place), solve = std::move(solve)](const VecX& F) {
      return refined(solve, place, D, F);
    };
  }

 private:
  // (1 + W D)^-1 F and (PROX-8), with the inverse of the closed blocks.
  std::optional<VecX> refined(const LinearSolve& solve, const std::vector<int>& place,
                              const std::vector<AnyBlock>& D, const VecX& F) const {
    const auto each_closed = [&](auto&& f) {
      for (int c = 0; c < count(); ++c)
        if (place[c] >= 0) f(c, place[c]);
    };
    Eigen::Index size = 0;
    each_closed([&](int c, int) { size += rows(c); });
    VecX d = VecX::Zero(F.size()), W_dr = VecX::Zero(F.size()), rhs(size);
    for (int k = 0; k <= kRefinements; ++k) {
      each_closed([&](int c, int i) {
        rhs.segment<R>(i, rows(c)) =
            F.segment<R>(at(c), rows(c)) - d.segment<R>(at(c), rows(c)) - W_dr.segment<R>(at(c), rows(c));
      });
      const VecX more = solve(rhs);
      VecX dr = VecX::Zero(F.size());
      each_closed([&](int c, int i) {
        d.segment<R>(at(c), rows(c)) += more.segment<R>(i, rows(c));
        dr.segment<R>(at(c), rows(c)) = RowBlock<R>(D[c]) * d.segment<R>(at(c), rows(c));
      });
      W_dr = B(dr);
    }
    for (int c = 0; c < count(); ++c)
      if (place[c] < 0)
        d.segment<R>(at(c), rows(c)) = F.segment<R>(at(c), rows(c)) - W_dr.segment<R>(at(c), rows(c));
    return d.allFinite() ? std::optional<VecX>(d) : std::nullopt;
  }

  // The first row of every closed block in a system of these alone, in an order with little fill; -1 of the
  // others.
  template <class IsClosed>
  std::vector<int> closed_blocks(IsClosed is_closed) {
    if (order_.empty()) {
      order_ = fill_reducing_order(rows_.begin, rows_.other);
      columns_ = block_columns(rows_, order_);
    }
    std::vector<int> place(std::size_t(count()), -1);
    int size = 0;
    for (const int c : order_)
      if (is_closed(c)) {
        place[c] = size;
        size += rows(c);
      }
    return place;
  }

  // 1 + W D of the blocks that have a place.
  template <class BlockOfD>
  CompressedColumns newton_matrix(const std::vector<int>& place, BlockOfD block_of_D) {
    CompressedColumns J;
    for (const int c : order_) {
      const auto column = std::size_t(c);
      if (place[column] < 0) continue;
      const RowBlock<R> D_c = block_of_D(c);
      const std::size_t from = J.value.size();
      std::size_t height = 0;
      for (int k = columns_.begin[column]; k < columns_.begin[column + 1]; ++k)
        if (const int i = columns_.other[k]; place[i] >= 0) height += std::size_t(rows(i));
      J.value.resize(from + height * std::size_t(rows(c)));
      J.row.resize(J.value.size());
      std::size_t top = 0;
      for (int k = columns_.begin[column]; k < columns_.begin[column + 1]; ++k) {
        const int i = columns_.other[k];
        if (place[i] < 0) continue;
        RowBlock<R> J_ic = columns_.block[k] * D_c;
        if (i == c) J_ic += RowBlock<R>::Identity(rows(c), rows(c));
        for (int b = 0; b < rows(c); ++b)
          for (int a = 0; a < rows(i); ++a) {
            const std::size_t slot = from + std::size_t(b) * height + top + std::size_t(a);
            J.value[slot] = J_ic(a, b);
            J.row[slot] = place[i] + a;
          }
        top += std::size_t(rows(i));
      }
      for (int b = 1; b <= rows(c); ++b) J.begin.push_back(int(from + std::size_t(b) * height));
    }
    return J;
  }

  Eigen::Index at(int c) const { return R == Eigen::Dynamic ? first[c] : R * c; }
  int rows(int c) const { return R == Eigen::Dynamic ? scaled.laws[c].rows : R; }
  const Block<R>& prepared(int c) {
    std::optional<Block<R>>& block = diagonal_[c];
    if (!block) block = prepare_block(rows_.block[own_[c]], scaled.laws[c]);
    return *block;
  }
  Rows<R> times(int c, const VecX& r) const {
    Rows<R> sum = Rows<R>::Zero(rows(c));
    for (int k = rows_.begin[c]; k < rows_.begin[std::size_t(c) + 1]; ++k) {
      const int d = rows_.other[k];
      sum.noalias() += rows_.block[k] * r.segment<R>(at(d), rows(d));
    }
    return sum;
  }
  Rows<R> velocity(int c, const VecX& r) const { return times(c, r) + scaled.q.segment<R>(at(c), rows(c)); }

  Blocks<R> rows_{}, columns_{};  // columns and order are made when Newton first needs them
  std::vector<int> order_{};
  std::vector<std::size_t> own_{};                   // places of the diagonal in rows_
  std::vector<std::optional<Block<R>>> diagonal_{};  // of blocks that a sweep has found closed
};

}  // namespace

std::unique_ptr<Delassus> make_delassus(const LocalProblem& problem) {
  return with_rows(problem.laws, [&]<int R>() -> std::unique_ptr<Delassus> {
    return std::make_unique<LocalDelassus<R>>(problem);
  });
}

}  // namespace aussois
