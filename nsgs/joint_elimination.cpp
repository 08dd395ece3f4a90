// SPDX-License-Identifier: Apache-2.0
#include "nsgs/joint_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/SparseLU>

namespace aussois {

// Proximal steps (JNT-3) on S lambda = x, S = G^T M^-1 G: the rows of S are scaled to a diagonal of one, a
// compliance kProximal is added, and what it left out is asked for again. From zero they stay in the range of
// S and end in the solution of smallest (scaled) norm.
struct JointFactor {
  SparseMatrix S{};  // scaled
  VecX scale{};
  Eigen::SparseLU<SparseMatrix> lu{};

  VecX solve(const VecX& x) const;
};

namespace {

constexpr double kProximal = 1e-8;
constexpr int kProximalSteps = 20;

// A B with few entries in every column, which are in order: without transposing it twice for that.
SparseMatrix product(const SparseMatrix& A, const SparseMatrix& B) {
  SparseMatrix out(A.rows(), B.cols());
  out.reserve(2 * B.nonZeros());
  std::vector<double> sum_of(std::size_t(A.rows()));
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

}  // namespace

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
  if (joints) v -= Y * joints->solve(Gt * v);
  return v;
}

SparseMatrix MotionInverse::operator*(const SparseMatrix& X) const {
  SparseMatrix V = mass * X;
  if (!joints) return V;
  std::vector<Triplet> entries;
  for (int j = 0; j < V.outerSize(); ++j) {
    VecX v = V.col(j);
    v -= Y * joints->solve(Gt * v);
    for (int i = 0; i < v.size(); ++i)
      if (v[i] != 0) entries.emplace_back(i, j, v[i]);
  }
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
  out.lambda = -inverse.joints->solve(inverse.Gt * out.v + problem.b);
  out.v += inverse.Y * out.lambda;
  return out;
}

LocalProblem condense(const FrictionProblem& problem) {
  validate(problem);
  const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
  if (!inverse) throw std::runtime_error("condense: FrictionProblem::M is singular or not finite");
  return condense(problem, *inverse);
}

LocalProblem condense(const FrictionProblem& problem, const MotionInverse& inverse) {
  if (problem.laws.empty()) return {};
  const SparseMatrix Ht = problem.H.transpose();
  LocalProblem local{.W = product(Ht, inverse * problem.H), .laws = problem.laws};
  if (problem.R.size() > 0) local.W += SparseMatrix(problem.R.asDiagonal());
  local.q = Ht * free_velocity(problem, inverse) + problem.w;
  return local;
}

}  // namespace aussois
