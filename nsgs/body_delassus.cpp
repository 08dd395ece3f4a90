// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include <Eigen/LU>

#include "nsgs/block_solver.hpp"
#include "nsgs/body_lu.hpp"
#include "nsgs/delassus.hpp"
#include "nsgs/factorised.hpp"
#include "nsgs/sparse_lu.hpp"

namespace aussois {

namespace {

constexpr Eigen::Index kDenseSize = 150;  // velocities; above, sparse LU
constexpr double kLargestCost = 2e7;      // of LU by bodies; above, sparse LU, which finds better orders
constexpr double kRefined = 1e-10;        // of the right-hand side: Newton makes up for it
constexpr double kExact = 1e-6;  // what LU by bodies may leave of the right-hand side, after refinement

// One row of the columns of a block, in H and in M^-1 H, scaled.
template <int R>
struct Arm {
  Rows<R> H{}, Y{};
  int row = 0;
};

// What a block's columns of H do to one body; zero in places that the body does not have.
template <int R>
struct Limb {
  Eigen::Matrix<double, kBodyRows, R, Eigen::ColMajor, kBodyRows, R == Eigen::Dynamic ? kMaxRows : R> H{};
  int body = 0;
};

template <int R>
class BodyDelassus final : public Delassus {
 public:
  BodyDelassus(const FrictionProblem& problem, const MassInverse& inverse) : M_(problem.M) {
    first = first_rows(problem.laws);
    begin_.reserve(problem.laws.size() + 1);
    begin_.push_back(0);
    arms_.reserve(problem.H.nonZeros());
    VecX diagonal = VecX::Zero(problem.w.size());
    for (std::size_t c = 0; c < problem.laws.size(); ++c) {
      append(problem.H, inverse, first[c], problem.laws[c].rows);
      Rows<R> sum = Rows<R>::Zero(problem.laws[c].rows);
      for (const Arm<R>& arm : arms(int(c))) sum += arm.H.cwiseProduct(arm.Y);
      diagonal.segment<R>(first[c], problem.laws[c].rows) = sum;
    }
    const VecX v_free = inverse * problem.f;
    scaled = scaling(diagonal, problem.H.transpose() * v_free + problem.w, problem.laws);
    if (!scaled.finite) return;
    dv_ = VecX::Zero(v_free.size());
    own_.reserve(problem.laws.size());
    prepared_.resize(problem.laws.size());
    weight_ = VecX(problem.M.diagonal()).cwiseAbs().cwiseInverse();
    scale_ = weight_.cwiseSqrt();
    for (int c = 0; c < count(); ++c) {
      const Rows<R> s = scaled.s.segment<R>(at(c), rows(c));
      RowBlock<R> W = RowBlock<R>::Zero(rows(c), rows(c));
      for (std::size_t k = begin_[c]; k < begin_[std::size_t(c) + 1]; ++k) {
        Arm<R>& arm = arms_[k];
        arm.H.array() *= s.array();
        arm.Y.array() *= s.array();
        W += arm.H * arm.Y.transpose();
      }
      own_.push_back(W);
      scaled.finite = scaled.finite && W.allFinite();
    }
  }

  VecX velocity(const VecX& r) override {
    dv_.setZero();
    for (int c = 0; c < count(); ++c) add(c, r.segment<R>(at(c), rows(c)));
    VecX u(r.size());
    for (int c = 0; c < count(); ++c) u.segment<R>(at(c), rows(c)) = velocity(c);
    return u;
  }

  BlockChange relax(int c, VecX& r, const SweepOptions& options) override {
    const Law& law = scaled.laws[c];
    const Rows<R> r_old = r.segment<R>(at(c), rows(c)), u = velocity(c);
    if (has_normal(law) && u[0] >= 0 && r_old[0] == 0) return {};  // stays open (NSGS-6)
    const Block<R>& block = prepared(c);
    const BlockSolution<R> found = solve_block(block, u - block.W * r_old, law, r_old, options.local);
    const Rows<R> dr = options.relaxation * (found.r - r_old);
    r.segment<R>(at(c), rows(c)) += dr;
    add(c, dr);
    return {dr.squaredNorm(), !found.solved, found.fail_safe};
  }

  std::vector<int> colours() const override {
    std::vector<std::vector<int>> used(
        std::size_t(dv_.size()));  // per velocity: colours of its blocks so far
    std::vector<int> colour(scaled.laws.size()), last(colour.size() + 1, -1);
    for (std::size_t c = 0; c < colour.size(); ++c) {
      for (const Arm<R>& arm : arms(int(c)))
        for (const int other : used[arm.row]) last[other] = int(c);
      while (last[colour[c]] == int(c)) ++colour[c];
      for (const Arm<R>& arm : arms(int(c))) used[arm.row].push_back(colour[c]);
    }
    return colour;
  }

  using Delassus::sweep;
  double sweep(VecX& r, const BlockRule& rule) override {
    double change = 0;
    for (int c = 0; c < count(); ++c) {
      const AnyRows r_old = r.segment(at(c), rows(c)), r_new = rule(c, velocity(c), r_old);
      r.segment(at(c), rows(c)) = r_new;
      const Rows<R> dr = r_new - r_old;
      add(c, dr);
      change += dr.squaredNorm();
    }
    return std::sqrt(change);
  }

  AnyBlock block(int c) const override { return own_[c]; }
  SparseMatrix matrix() const override {
    std::vector<Triplet> directions, motions;  // H^T and (M^-1 H), scaled
    for (int c = 0; c < count(); ++c)
      for (const Arm<R>& arm : arms(c))
        for (int i = 0; i < rows(c); ++i) {
          directions.emplace_back(at(c) + i, arm.row, arm.H[i]);
          motions.emplace_back(arm.row, at(c) + i, arm.Y[i]);
        }
    SparseMatrix Ht(scaled.q.size(), dv_.size()), Y(dv_.size(), scaled.q.size());
    Ht.setFromTriplets(directions.begin(), directions.end());
    Y.setFromTriplets(motions.begin(), motions.end());
    return Ht * Y;
  }
  // (W + s)^-1 b = (b - H^T d) / s with (M + H H^T / s) d = H b / s: of the size of the bodies.
  LinearSolve shifted_inverse(double shift) const override {
    const LinearSolve solve = factorised(newton_matrix(1 / shift));
    if (!solve) return {};
    return [this, solve, shift](const VecX& b) -> VecX {
      const VecX d = scale_.cwiseProduct(solve(scale_.cwiseProduct(B(b / shift))));
      return (b - C(d)) / shift;
    };
  }

  Eigen::Index unknowns() const override { return dv_.size(); }
  VecX A(const VecX& d) const override { return M_ * d; }
  VecX B(const VecX& dr) const override {
    VecX momentum = VecX::Zero(dv_.size());
    for (int c = 0; c < count(); ++c) {
      const Rows<R> dr_c = dr.segment<R>(at(c), rows(c));
      for (const Arm<R>& arm : arms(c)) momentum[arm.row] += arm.H.dot(dr_c);
    }
    return momentum;
  }
  VecX C(const VecX& d) const override {
    VecX du(scaled.q.size());
    for (int c = 0; c < count(); ++c) {
      Rows<R> sum = Rows<R>::Zero(rows(c));
      for (const Arm<R>& arm : arms(c)) sum += arm.H * d[arm.row];
      du.segment<R>(at(c), rows(c)) = sum;
    }
    return du;
  }
  double size(const VecX& row) const override { return std::sqrt(row.cwiseAbs2().dot(weight_)); }
  double newton_cost(const VecX&) override {
    const double n = double(dv_.size()), arms = double(arms_.size()), contacts = count(),
                 sweep = contacts * 80 + 12 * arms,  // the blocks' own solves, and velocities
        assembly = 6 * arms * arms / contacts;
    if (by_bodies()) return (by_bodies()->cost() + assembly) / sweep + 1;
    if (is_dense()) return (2 * n * n * n / 3 + assembly) / sweep + 1;
    if (!sparse_cost_) {
      CompressedColumns J = compressed(newton_matrix(1));  // its pattern with all blocks closed
      sparse_cost_ = factor_cost(J);
    }
    return (*sparse_cost_ + assembly) / sweep + 2;
  }

  NewtonSolve newton_inverse(std::vector<AnyBlock> D) override {
    LinearSolve bodies = by_bodies() ? body_inverse(D) : LinearSolve();
    LinearSolve whole = bodies ? LinearSolve() : whole_inverse(D);
    return [this, D = std::move(D), bodies = std::move(bodies),
            whole = std::move(whole)](const VecX& F) -> std::optional<VecX> {
      if (bodies)
        if (std::optional<VecX> d = refined(bodies, D, F, kExact)) return d;
      return refined(bodies ? whole_inverse(D) : whole, D, F, kInf);
    };
  }

 private:
  Eigen::Index at(int c) const { return R == Eigen::Dynamic ? first[c] : R * c; }
  int rows(int c) const { return R == Eigen::Dynamic ? scaled.laws[c].rows : R; }
  bool is_dense() const { return dv_.size() <= kDenseSize; }

  std::span<const Arm<R>> arms(int c) const {
    const std::size_t from = begin_[c];
    return std::span(arms_).subspan(from, begin_[std::size_t(c) + 1] - from);
  }

  Rows<R> velocity(int c) const {
    Rows<R> u = scaled.q.segment<R>(at(c), rows(c));
    for (const Arm<R>& arm : arms(c)) u += arm.H * dv_[arm.row];
    return u;
  }
  void add(int c, const Rows<R>& dr) {
    for (const Arm<R>& arm : arms(c)) dv_[arm.row] += arm.Y.dot(dr);
  }
  const Block<R>& prepared(int c) {  // made when a sweep first needs it
    std::optional<Block<R>>& block = prepared_[c];
    if (!block) block = prepare_block(own_[c], scaled.laws[c]);
    return *block;
  }

  // The arms of one block: rows that its columns move, and those that M couples these with; ascending.
  void append(const SparseMatrix& H, const MassInverse& inverse, int column, int columns) {
    std::vector<int>& moved = scratch_;
    moved.clear();
    for (int j = column; j < column + columns; ++j) {
      const std::span rows(H.innerIndexPtr() + H.outerIndexPtr()[j],
                           std::size_t(H.outerIndexPtr()[j + 1] - H.outerIndexPtr()[j]));
      if (!std::ranges::equal(rows, moved)) moved.insert(moved.end(), rows.begin(), rows.end());
    }
    const std::size_t of_columns = moved.size();
    for (std::size_t k = 0; k < of_columns; ++k) {
      const int b = inverse.block_of[moved[k]], n = inverse.size(b);
      if (n == 1) continue;
      const auto coupled = std::span(inverse.rows).subspan(std::size_t(inverse.first[b]), std::size_t(n));
      if (const auto here = std::span(moved).first(of_columns).subspan(k);
          here.size() >= coupled.size() && std::ranges::equal(here.first(coupled.size()), coupled))
        k += coupled.size() - 1;  // they are all there, as of whole bodies
      else
        moved.insert(moved.end(), coupled.begin(), coupled.end());
    }
    if (std::ranges::adjacent_find(moved, std::greater_equal()) != moved.end()) {
      std::ranges::sort(moved);
      moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
    }
    const std::size_t from = arms_.size();
    arms_.resize(from + moved.size(), {Rows<R>::Zero(columns), Rows<R>::Zero(columns)});
    begin_.push_back(arms_.size());
    const auto added = std::span(arms_).subspan(from);
    for (std::size_t k = 0; k < moved.size(); ++k) added[k].row = moved[k];
    for (int j = 0; j < columns; ++j) {
      auto arm = added.begin();
      for (SparseMatrix::InnerIterator it(H, column + j); it; ++it, ++arm) {
        while (arm->row != int(it.row())) ++arm;
        arm->H[j] = it.value();
      }
    }
    for (auto arm = added.begin(); arm != added.end(); ++arm) {
      const int b = inverse.block_of[arm->row], n = inverse.size(b);
      const double* inv = inverse.inverse.data() + inverse.at[b];
      if (n == 1) {
        arm->Y = *inv * arm->H;
        continue;
      }
      int i = 0;
      while (inverse.row(b, i) != arm->row) ++i;
      auto other =
          arm - std::min<std::ptrdiff_t>(i, arm - added.begin());  // where M couples neighbours alone
      for (int k = 0; k < n; ++k, ++other) {
        const int row = inverse.row(b, k);
        if (other == added.end() || other->row != row)
          other = std::ranges::lower_bound(added, row, {}, &Arm<R>::row);
        arm->Y += inv[i + n * k] * other->H;
      }
    }
  }

  // J^-1 F and (PROX-8); nothing if more than `allowed` of F is left.
  std::optional<VecX> refined(const LinearSolve& solve, const std::vector<AnyBlock>& D, const VecX& F,
                              double allowed) const {
    if (!solve) return std::nullopt;
    const double whole = size(F);
    VecX d = solve(F);
    double left = kInf;
    for (int k = 0; k <= kRefinements && left > kRefined * whole; ++k) {
      const VecX rest = F - times(D, d);
      left = size(rest);
      if (k < kRefinements && left > kRefined * whole) d += solve(rest);
    }
    if (!d.allFinite() || (allowed < kInf && !(left <= allowed * whole))) return std::nullopt;
    return d;
  }

  // Velocities that the same contacts move belong to one body; nothing if that makes too much work.
  const BodyLu* by_bodies() const {
    if (!looked_for_bodies_) find_bodies();
    return lu_ ? &*lu_ : nullptr;
  }
  void find_bodies() const {
    looked_for_bodies_ = true;
    // Rows i - 1 and i are of one body if the same contacts move them: as many each as both.
    std::vector<int> contacts(dv_.size()), with_last(contacts.size()), body(contacts.size());
    for (int c = 0; c < count(); ++c) {
      int last = -2;
      for (const Arm<R>& arm : arms(c)) {
        ++contacts[arm.row];
        with_last[arm.row] += arm.row == last + 1;
        last = arm.row;
      }
    }
    for (std::size_t i = 1, rows = 1; i < body.size(); ++i) {
      const bool same = with_last[i] == contacts[i] && contacts[i] == contacts[i - 1] && rows < kBodyRows;
      body[i] = body[i - 1] + !same;
      rows = same ? rows + 1 : 1;
    }
    std::vector<std::pair<int, int>> couplings;
    couplings.reserve(begin_.size());
    std::vector<int> met;
    for (int c = 0; c < count(); ++c) {
      met.clear();
      for_runs(c, body, [&](std::span<const Arm<R>> run) {
        const int b = body[run.front().row];
        for (const int a : met) couplings.emplace_back(a, b);
        met.push_back(b);
      });
    }
    for (int j = 0; j < M_.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(M_, j); it; ++it)
        if (body[it.row()] != body[j]) couplings.emplace_back(body[it.row()], body[j]);
    lu_.emplace(std::move(body), couplings);
    if (lu_->cost() > kLargestCost)
      lu_.reset();
    else
      set_blocks();
  }
  // What the Newton matrices of BodyLu are made of, equilibrated.
  void set_blocks() const {
    mass_ = lu_->zero();
    for (int j = 0; j < M_.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(M_, j); it; ++it)
        mass_[lu_->block(lu_->body(int(it.row())), lu_->body(j))](lu_->place(int(it.row())), lu_->place(j)) +=
            scale_[it.row()] * it.value() * scale_[j];
    limbs_begin_.reserve(begin_.size());
    limbs_begin_.push_back(0);
    limbs_.reserve(2 * begin_.size());
    for (int c = 0; c < count(); ++c) {
      for_runs(c, lu_->bodies(), [&](std::span<const Arm<R>> run) {
        Limb<R>& limb = limbs_.emplace_back();
        limb.body = lu_->body(run.front().row);
        limb.H.setZero(kBodyRows, rows(c));
        for (const Arm<R>& arm : run) limb.H.row(lu_->place(arm.row)) = scale_[arm.row] * arm.H.transpose();
      });
      limbs_begin_.push_back(limbs_.size());
    }
  }
  // Calls f with all arms of one body.
  template <class F>
  void for_runs(int c, const std::vector<int>& body, const F& f) const {
    const std::span<const Arm<R>> all = arms(c);
    for (std::size_t from = 0, to = 0; from < all.size(); from = to) {
      const int own = body[all[from].row];
      while (to < all.size() && body[all[to].row] == own) ++to;
      f(all.subspan(from, to - from));
    }
  }

  LinearSolve body_inverse(const std::vector<AnyBlock>& D) const {
    std::vector<Mat6> blocks = mass_;
    for (int c = 0; c < count(); ++c) {
      if (D[c].isZero(0)) continue;
      const RowBlock<R>& D_c = D[c];
      const auto limbs =
          std::span(limbs_).subspan(limbs_begin_[c], limbs_begin_[std::size_t(c) + 1] - limbs_begin_[c]);
      for (const Limb<R>& j : limbs) {
        const auto answer = (D_c * j.H.transpose()).eval();
        for (const Limb<R>& i : limbs)
          blocks[lu_->block(i.body, j.body)].noalias() += i.H.lazyProduct(answer);
      }
    }
    if (!lu_->factorise(std::move(blocks))) return {};
    return [this](const VecX& b) -> VecX { return scale_.cwiseProduct(lu_->solve(scale_.cwiseProduct(b))); };
  }

  // H_c D_c H_c^T of all blocks, entry by entry.
  template <class Add>
  void add_compliance(const std::vector<AnyBlock>& D, Add add_entry) const {
    for (int c = 0; c < count(); ++c) {
      if (D[c].isZero(0)) continue;
      const RowBlock<R>& D_c = D[c];
      for (const Arm<R>& j : arms(c)) {
        const Rows<R> column = D_c * j.H;
        for (const Arm<R>& i : arms(c)) add_entry(i.row, j.row, i.H.dot(column));
      }
    }
  }

  // (M + H D H^T) d factor by factor: where D is large the sum has lost M's last digits.
  VecX times(const std::vector<AnyBlock>& D, const VecX& d) const {
    VecX s = C(d);
    for (int c = 0; c < count(); ++c)
      s.segment<R>(at(c), rows(c)) = RowBlock<R>(D[c]) * s.segment<R>(at(c), rows(c)).eval();
    return A(d) + B(s);
  }

  LinearSolve whole_inverse(const std::vector<AnyBlock>& D) const {
    return is_dense() ? dense_inverse(D) : sparse_inverse(D);
  }
  LinearSolve dense_inverse(const std::vector<AnyBlock>& D) const {
    MatX J = M_;
    add_compliance(D, [&](int i, int j, double value) { J(i, j) += value; });
    const auto factor =
        std::make_shared<Eigen::PartialPivLU<MatX>>(scale_.asDiagonal() * J * scale_.asDiagonal());
    return [this, factor](const VecX& b) -> VecX {
      return scale_.cwiseProduct(factor->solve(scale_.cwiseProduct(b)));
    };
  }

  // M + H D H^T, equilibrated.
  SparseMatrix newton_matrix(const std::vector<AnyBlock>& D) const {
    std::vector<Triplet> entries;
    for (int j = 0; j < M_.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(M_, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
    add_compliance(D, [&](int i, int j, double value) { entries.emplace_back(i, j, value); });
    SparseMatrix J(M_.rows(), M_.cols());
    J.setFromTriplets(entries.begin(), entries.end());
    return scale_.asDiagonal() * J * scale_.asDiagonal();
  }
  SparseMatrix newton_matrix(double d) const {  // D = d
    std::vector<AnyBlock> D;
    for (int c = 0; c < count(); ++c) D.emplace_back(AnyBlock::Identity(rows(c), rows(c)) * d);
    return newton_matrix(D);
  }

  LinearSolve sparse_inverse(const std::vector<AnyBlock>& D) const {
    const LinearSolve solve = factorised(newton_matrix(D));
    if (!solve) return {};
    return
        [this, solve](const VecX& b) -> VecX { return scale_.cwiseProduct(solve(scale_.cwiseProduct(b))); };
  }

  SparseMatrix M_{};
  std::vector<Arm<R>> arms_{};
  std::vector<std::size_t> begin_{};
  std::vector<int> scratch_{};
  std::vector<RowBlock<R>> own_{};                   // the diagonal of W
  std::vector<std::optional<Block<R>>> prepared_{};  // of blocks that a sweep has found closed
  VecX weight_{};
  VecX dv_{};     // by the impulses: speeds that cancel in q are not there to be rounded again
  VecX scale_{};  // equilibrates: translations beside rotations
  std::optional<double> sparse_cost_{};
  mutable std::optional<BodyLu> lu_{};  // and the factors of the last Newton matrix
  mutable std::vector<Mat6> mass_{};    // as its blocks
  mutable std::vector<Limb<R>> limbs_{};
  mutable std::vector<std::size_t> limbs_begin_{};
  mutable bool looked_for_bodies_ = false;
};

}  // namespace

std::unique_ptr<Delassus> make_delassus(const FrictionProblem& problem, const MassInverse& inverse) {
  return with_rows(problem.laws, [&]<int R>() -> std::unique_ptr<Delassus> {
    return std::make_unique<BodyDelassus<R>>(problem, inverse);
  });
}

}  // namespace aussois
