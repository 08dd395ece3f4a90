// SPDX-License-Identifier: Apache-2.0
#include "nsgs/joint_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/SparseLU>

#include "nsgs/sparse_lu.hpp"

namespace aussois {

namespace {

constexpr double kProximal = 1e-8;
constexpr int kProximalSteps = 20;
constexpr double kLightest = 1e-4;  // of the mass along a column; S keeps 12 digits of the others then

}  // namespace

// Both equations at once (JNT-5), of the rows of M that G touches; the rows are scaled by the masses of
// (JNT-6), the columns of G to the metric that these give, where the compliance is kProximal.
struct Saddle {
  std::vector<int> rows{};
  SparseMatrix M{}, G{};  // scaled
  VecX row_scale{}, column_scale{};
  std::function<VecX(const VecX&)> inverse{};

  // M v - G lambda = x, G^T v = y; v and x of all rows, those that G does not touch left as they are.
  VecX solve(const VecX& x, const VecX& y, VecX& v) const;
};

// Proximal steps (JNT-3) on S lambda = x, S = G^T M^-1 G: the rows of S are scaled to a diagonal of one, a
// compliance kProximal is added, and what it left out is solved for again. From zero they stay in the range
// of S and end in the solution of smallest (scaled) norm.
struct JointFactor {
  SparseMatrix S{};  // scaled
  VecX scale{};
  Eigen::SparseLU<SparseMatrix> lu{};
  std::optional<Saddle> saddle{};  // instead, where S would lose the digits of heavy directions

  VecX solve(const VecX& x) const;
};

namespace {

// A B with few entries in every column, which are in order: without transposing it twice for that.
SparseMatrix product(const SparseMatrix& A, const SparseMatrix& B) {
  SparseMatrix out(A.rows(), B.cols());
  out.reserve(2 * B.nonZeros());
  std::vector<double> sum_of(A.rows());
  std::vector<int> rows(sum_of.size()), last_of(sum_of.size(), -1);  // column that touched a row last
  double* const sum = sum_of.data();                                 // bare: this loop is most of condense()
  int* const last = last_of.data();
  for (int j = 0; j < B.outerSize(); ++j) {
    int* end = rows.data();
    for (SparseMatrix::InnerIterator b(B, j); b; ++b) {
      const double factor = b.value();
      for (SparseMatrix::InnerIterator a(A, int(b.row())); a; ++a) {
        const auto i = a.row();
        if (last[i] != j) {
          last[i] = j;
          sum[i] = 0;
          *end++ = int(i);
        }
        sum[i] += a.value() * factor;
      }
    }
    std::sort(rows.data(), end);
    out.startVec(j);
    for (const int* i = rows.data(); i < end; ++i) out.insertBackByOuterInner(j, *i) = sum[*i];
  }
  out.finalize();
  return out;
}

// The mass that moves with speed one along each column, were all of its velocities in the column's ratios.
VecX masses_along(const SparseMatrix& G, const VecX& mass) {
  const SparseMatrix squares = G.cwiseProduct(G);
  const VecX size = squares.transpose() * VecX::Ones(G.rows());
  return (squares.transpose() * mass).cwiseQuotient(size.cwiseAbs2());
}

// What velocities weigh where joints hold them (JNT-6): at least what moves along a column with them.
VecX held_masses(const SparseMatrix& G, const VecX& mass) {
  const VecX along = masses_along(G, mass);
  VecX out = mass;
  for (int k = 0; k < G.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(G, k); it; ++it)
      out[it.row()] = std::max(out[it.row()], it.value() * it.value() * along[k]);
  return out;
}

// Rows of the blocks of M that G touches, ascending.
std::vector<int> touched_rows(const MassInverse& mass, const SparseMatrix& G) {
  std::vector<char> touched(std::size_t(mass.count()));
  for (int k = 0; k < G.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(G, k); it; ++it) touched[mass.block_of[it.row()]] = 1;
  std::vector<int> out;
  for (int i = 0; i < int(G.rows()); ++i)
    if (touched[mass.block_of[i]]) out.push_back(i);
  return out;
}

// The rows `rows` of A, and of its columns all or the same.
SparseMatrix rows_of(const SparseMatrix& A, const std::vector<int>& rows, bool columns_too) {
  std::vector<int> place(std::size_t(A.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) place[rows[i]] = int(i);
  std::vector<Triplet> entries;
  for (int j = 0; j < A.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      const int row = place[it.row()], column = columns_too ? place[j] : j;
      if (row >= 0 && column >= 0) entries.emplace_back(row, column, it.value());
    }
  SparseMatrix out(Eigen::Index(rows.size()), columns_too ? Eigen::Index(rows.size()) : A.cols());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// Of a matrix whose pattern is symmetric, in an order that fills in little.
std::function<VecX(const VecX&)> ordered_inverse(const SparseMatrix& A) {
  const CompressedColumns columns = compressed(A);
  const std::vector<int> order = fill_reducing_order(columns.begin, columns.row);
  Eigen::PermutationMatrix<Eigen::Dynamic> from(A.rows());
  std::ranges::copy(order, from.indices().data());
  const SparseMatrix permuted = from.transpose() * A * from;
  const std::function<VecX(const VecX&)> inverse = inverse_of(compressed(permuted));
  if (!inverse) return {};
  return [inverse, from](const VecX& b) -> VecX { return from * inverse(from.transpose() * b); };
}

std::optional<Saddle> saddle_of(const SparseMatrix& M, const SparseMatrix& G, const MassInverse& mass,
                                const VecX& held) {
  Saddle out{.rows = touched_rows(mass, G)};
  out.row_scale = held(out.rows).cwiseSqrt().cwiseInverse();
  out.column_scale = masses_along(G, held).cwiseSqrt();
  for (double& s : out.column_scale)
    if (!std::isfinite(s)) s = 0;  // a joint between things that cannot move
  out.M = out.row_scale.asDiagonal() * rows_of(M, out.rows, true) * out.row_scale.asDiagonal();
  out.G = out.row_scale.asDiagonal() * rows_of(G, out.rows, false) * out.column_scale.asDiagonal();
  const Eigen::Index n = out.M.rows(), p = out.G.cols();
  std::vector<Triplet> entries;
  for (int j = 0; j < n; ++j)
    for (SparseMatrix::InnerIterator it(out.M, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
  for (int k = 0; k < p; ++k) {
    for (SparseMatrix::InnerIterator it(out.G, k); it; ++it) {
      entries.emplace_back(it.row(), n + k, -it.value());
      entries.emplace_back(n + k, it.row(), it.value());
    }
    entries.emplace_back(n + k, n + k, kProximal);
  }
  SparseMatrix both(n + p, n + p);
  both.setFromTriplets(entries.begin(), entries.end());
  out.inverse = ordered_inverse(both);
  return out.inverse ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace

VecX Saddle::solve(const VecX& x, const VecX& y, VecX& v) const {
  const Eigen::Index n = M.rows(), p = G.cols();
  VecX target(n + p), found = VecX::Zero(n + p);
  target << row_scale.cwiseProduct(x(rows)), column_scale.cwiseProduct(y);
  double wrong = kInf;
  const auto times = [&](const VecX& z) -> VecX {
    VecX out(n + p);
    out << M * z.head(n) - G * z.tail(p), G.transpose() * z.head(n);
    return out;
  };
  for (int step = 0; step < kProximalSteps; ++step) {
    const VecX left = target - times(found);
    const double now = left.norm();
    if (!(now < wrong / 2) || now <= 1e-16 * target.norm()) break;
    wrong = now;
    VecX change = inverse(left), rounded = left - times(change);
    rounded.tail(p) -= kProximal * change.tail(p);
    found += change + inverse(rounded);  // what rounding gave to redundant columns would stay
  }
  v(rows) = row_scale.cwiseProduct(found.head(n));
  return column_scale.cwiseProduct(found.tail(p));
}

VecX JointFactor::solve(const VecX& x) const {
  const VecX target = scale.asDiagonal() * x;
  VecX lambda = VecX::Zero(x.size());
  double wrong = kInf;
  for (int step = 0; step < kProximalSteps; ++step) {
    const VecX left = target - S * lambda;
    const double now = left.norm();
    if (!(now < wrong / 2) || now <= 1e-16 * target.norm()) break;
    wrong = now;
    lambda += lu.solve(left);
  }
  return scale.asDiagonal() * lambda;
}

VecX MotionInverse::operator*(const VecX& x) const {
  VecX v = mass * x;
  if (!joints) return v;
  if (joints->saddle)
    joints->saddle->solve(x, VecX::Zero(Gt.rows()), v);
  else
    v -= Y * joints->solve(Gt * v);
  return v;
}

SparseMatrix MotionInverse::operator*(const SparseMatrix& X) const {
  if (!joints) return mass * X;
  std::vector<Triplet> entries;
  for (int j = 0; j < X.outerSize(); ++j) {
    const VecX v = *this * VecX(X.col(j));
    for (int i = 0; i < v.size(); ++i)
      if (v[i] != 0) entries.emplace_back(i, j, v[i]);
  }
  SparseMatrix V(X.rows(), X.cols());
  V.setFromTriplets(entries.begin(), entries.end());
  return V;
}

std::optional<MotionInverse> invert_motion(const SparseMatrix& M, const SparseMatrix& G) {
  std::optional<MassInverse> mass = invert_mass(M);
  if (!mass) return std::nullopt;
  MotionInverse inverse{.mass = std::move(*mass)};
  if (G.cols() == 0) return inverse;
  inverse.Gt = G.transpose();
  inverse.Y = inverse.mass * G;
  auto factor = std::make_shared<JointFactor>();
  factor->S = inverse.Gt * inverse.Y;
  const VecX held = held_masses(G, VecX(M.diagonal()).cwiseAbs());
  const VecX lightness = VecX(factor->S.diagonal()).cwiseProduct(masses_along(G, held));
  if ((lightness.array() > 1 / kLightest).any()) {
    factor->saddle = saddle_of(M, G, inverse.mass, held);
    if (!factor->saddle) return std::nullopt;
    inverse.joints = std::move(factor);
    return inverse;
  }
  factor->scale = VecX(factor->S.diagonal()).cwiseSqrt().cwiseInverse();
  for (double& s : factor->scale)
    if (!std::isfinite(s)) s = 0;  // a joint between things that cannot move
  factor->S = factor->scale.asDiagonal() * factor->S * factor->scale.asDiagonal();
  SparseMatrix proximal(G.cols(), G.cols());
  proximal.setIdentity();
  factor->lu.compute(SparseMatrix(factor->S + kProximal * proximal));
  if (factor->lu.info() != Eigen::Success) return std::nullopt;
  inverse.joints = std::move(factor);
  return inverse;
}

VecX free_velocity(const FrictionProblem& problem, const MotionInverse& inverse) {
  return motion(problem, inverse, VecX::Zero(problem.w.size())).v;
}

JointedMotion motion(const FrictionProblem& problem, const MotionInverse& inverse, const VecX& r) {
  JointedMotion out;
  out.v = inverse.mass * (r.size() > 0 ? VecX(problem.f + problem.H * r) : problem.f);
  out.lambda = VecX::Zero(problem.b.size());
  if (!inverse.joints) return out;
  if (inverse.joints->saddle) {
    out.lambda = inverse.joints->saddle->solve(r.size() > 0 ? VecX(problem.f + problem.H * r) : problem.f,
                                               -problem.b, out.v);
    return out;
  }
  out.lambda = -inverse.joints->solve(inverse.Gt * out.v + problem.b);
  out.v += inverse.Y * out.lambda;
  return out;
}

LocalProblem condense(const FrictionProblem& problem) {
  validate(problem);
  const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
  if (!inverse) throw std::runtime_error("condense: FrictionProblem::M is singular or not finite");
  return condense_with_inverse(problem, *inverse);
}

LocalProblem condense_with_inverse(const FrictionProblem& problem, const MotionInverse& inverse) {
  if (problem.laws.empty()) return {};
  const SparseMatrix Ht = problem.H.transpose();
  LocalProblem local{.W = product(Ht, inverse * problem.H), .laws = problem.laws};
  if (problem.R.size() > 0) local.W += SparseMatrix(problem.R.asDiagonal());
  local.q = Ht * free_velocity(problem, inverse) + problem.w;
  return local;
}

}  // namespace aussois
