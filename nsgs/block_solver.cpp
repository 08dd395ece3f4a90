// SPDX-License-Identifier: Apache-2.0
#include "nsgs/block_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <Eigen/QR>

#include "nsgs/slip_compliance.hpp"

namespace aussois {

namespace {

template <int R>
Block<R> prepared(const RowBlock<R>& W, const Law& law) {
  Block<R> block{.W = W, .rho = Rows<R>::Constant(W.rows(), 1 / W(0, 0))};
  block.norm = W.norm();
  if constexpr (R == Eigen::Dynamic || R > 4)
    block.inverse = W.partialPivLu().inverse();
  else
    block.inverse = W.inverse();
  block.regular = block.inverse.allFinite();
  for (const Ball& ball : balls(law)) {
    double bound = 0;  // of the eigenvalues of its rows
    for (int i = ball.first; i < ball.first + ball.rows; ++i) {
      double sum = 0;
      for (int j = ball.first; j < ball.first + ball.rows; ++j) sum += std::abs(W(i, j));
      bound = std::max(bound, sum);
    }
    for (int i = ball.first; i < ball.first + ball.rows; ++i) block.rho[i] = 1 / std::max(bound, 1e-300);
  }
  return block;
}

constexpr double kLocked =
    1e-12;  // normal of a block of unit size that no impulse can move, but for rounding
constexpr double kTolerance = 3e-14;      // a few roundings of W r + q (ONE-6)
constexpr double kLargestImpulse = 1e13;  // |W| |r| over |q|: beyond, the rounding of r is a thousandth of q
constexpr int kNewtonSteps = 20;

template <int R>
struct Candidate {
  Rows<R> r{};
  double wrong = kInf;
  bool good = false;
};

template <int R>
double allowed(const Block<R>& block, const Rows<R>& q, const Rows<R>& r) {  // (ONE-6)
  const double size = q.norm();
  return std::min(kTolerance * (size + block.norm * r.norm()), 1e-6 * size);
}

template <int R>
Candidate<R> judged(const Block<R>& block, const Rows<R>& q, const Law& law, const Rows<R>& r) {
  const Rows<R> u = block.W * r + q;
  const double wrong = (r - project<R>(law, r - modified_velocity<R>(law, u))).norm();
  return {r, std::isfinite(wrong) ? wrong : kInf, wrong <= allowed<R>(block, q, r)};
}

// r = block_answer(r - rho u) by Newton (ONE-2).
template <int R>
Candidate<R> newton(const Block<R>& block, const Rows<R>& q, const Law& law, const Rows<R>& start) {
  Candidate<R> best = judged<R>(block, q, law, start);
  Rows<R> r = start;
  const auto n = start.size();
  const RowBlock<R> I_minus_rho_W = RowBlock<R>::Identity(n, n) - block.rho.asDiagonal() * block.W;
  for (int step = 0; step < kNewtonSteps && !best.good; ++step) {
    const Rows<R> y = I_minus_rho_W * r - block.rho.cwiseProduct(q);
    const RowBlock<R> J = RowBlock<R>::Identity(n, n) - answer_derivative<R>(law, y) * I_minus_rho_W;
    const Rows<R> wrong = r - block_answer<R>(law, y);
    if constexpr (R != Eigen::Dynamic && R <= 4)
      r -= J.inverse() * wrong;
    else
      r -= J.partialPivLu().solve(wrong);
    if (!r.allFinite()) break;
    const Candidate<R> now = judged<R>(block, q, law, r);
    if (now.wrong < best.wrong) best = now;
  }
  return best;
}

// Newton on blocks made easier by a compliance about the last answer, less of it each time (ONE-9).
template <int R>
Candidate<R> proximal(const Block<R>& block, const Rows<R>& q, const Law& law, const Rows<R>& start) {
  Candidate<R> best = judged<R>(block, q, law, start);
  Rows<R> center = start;
  const auto n = start.size();
  for (double alpha = 10; alpha > 1e-12 && !best.good; alpha /= 4) {
    const Block<R> softer = prepared<R>(block.W + alpha * RowBlock<R>::Identity(n, n), law);
    const Candidate<R> found = newton<R>(softer, q - alpha * center, law, center);
    if (!found.r.allFinite()) break;
    center = found.r;
    const Candidate<R> now = judged<R>(block, q, law, center);
    if (now.wrong < best.wrong) best = now;
  }
  return best;
}

// Stick or slip by the compliance of the slip (ONE-4), (ONE-5); a planar contact has a third row in which
// nothing moves.
template <int R>
Candidate<R> enumerated(const Block<R>& block, const Rows<R>& q, const Law& law) {
  Mat3 W = Mat3::Identity();
  W.topLeftCorner<R, R>() = block.W;
  Vec3 q_3 = Vec3::Zero();
  q_3.head<R>() = q;
  Candidate<R> near = judged<R>(
      block, q, law, solve_by_slip_compliance(W, q_3, law.mu, Digits::sixteen).r.template head<R>());
  if (!near.good) near = newton<R>(block, q, law, near.r);
  if (near.good) return near;
  const ExactContact exact = solve_by_slip_compliance(W, q_3, law.mu, Digits::thirty_two);
  const Rows<R> r = exact.r.head<R>();
  const bool representable = block.norm * r.norm() <= kLargestImpulse * q.norm();
  if (representable && exact.wrong <= allowed<R>(block, q, r)) return {r, exact.wrong, true};
  const Candidate<R> rounded = judged<R>(block, q, law, r);
  return rounded.wrong < near.wrong ? rounded : near;
}

// A planar contact slips one way or the other (ONE-8).
inline Candidate<2> slip_2d(const Block<2>& block, const Rows<2>& q, const Law& law) {
  Candidate<2> best{.r = Rows<2>::Zero()};
  for (const double side : {-1.0, 1.0}) {
    const double normal = -q[0] / (block.W(0, 0) + side * law.mu * block.W(0, 1));
    if (!(normal >= 0) || !std::isfinite(normal)) continue;
    const Candidate<2> now = judged<2>(block, q, law, {normal, side * law.mu * normal});
    if (now.wrong < best.wrong) best = now;
  }
  return best;
}

template <int R>
BlockSolution<R> solved(const Block<R>& block, const Rows<R>& q, const Law& law, const Rows<R>& start,
                        LocalSolver solver) {
  const auto n = q.size();
  if (has_normal(law)) {
    if (q[0] >= 0) return {Rows<R>::Zero(n)};
    if (law.kind == LawKind::unilateral) return {Rows<R>::Constant(n, -q[0] / block.W(0, 0))};
    if (block.W(0, 0) < kLocked)  // (ONE-10)
      return {Rows<R>::Zero(n), judged<R>(block, q, law, Rows<R>::Zero(n)).good};
  }
  if (law.kind == LawKind::dry_friction)
    return {Rows<R>::Constant(n, std::clamp(-q[0] / block.W(0, 0), -law.limit, law.limit))};
  if (solver == LocalSolver::projection) {
    const Rows<R> u = modified_velocity<R>(law, Rows<R>(block.W * start + q));
    const Rows<R> r = project<R>(law, start - block.rho.minCoeff() * u);
    return {r, judged<R>(block, q, law, r).good};
  }
  if (block.regular && solver != LocalSolver::alart_curnier) {
    const Rows<R> stick = -block.inverse * q;
    if (block_answer<R>(law, stick) == stick && judged<R>(block, q, law, stick).good)
      return {stick};  // (ONE-7)
  }
  if (law.kind == LawKind::bilateral) {
    const Rows<R> r = MatX(block.W).completeOrthogonalDecomposition().solve(VecX(-q));
    return {r, judged<R>(block, q, law, r).good};
  }
  Candidate<R> found{.r = Rows<R>::Zero(n)};
  if constexpr (R == 2) {
    found = slip_2d(block, q, law);
    if (found.good) return {found.r};
  }
  if (solver != LocalSolver::enumerative || R != 3) {
    Rows<R> from = start;
    if (!(start[0] > 0)) {  // the frictionless answer
      from.setZero();
      from[0] = -q[0] / block.W(0, 0);
    }
    const Candidate<R> by_newton = newton<R>(block, q, law, block_answer<R>(law, from));
    if (by_newton.wrong < found.wrong) found = by_newton;
  }
  if (found.good || solver == LocalSolver::alart_curnier) return {found.r, found.good};
  const bool fail_safe = solver == LocalSolver::hybrid;
  if constexpr (R == 2 || R == 3) {
    const Candidate<R> now = enumerated<R>(block, q, law);
    if (now.good || now.wrong < found.wrong) found = now;
  } else {
    const Candidate<R> now = proximal<R>(block, q, law, block_answer<R>(law, start));
    if (now.wrong < found.wrong) found = now;
  }
  return {found.r, found.good, fail_safe};
}

}  // namespace

// Overloads, not explicit instantiations: GCC 12 does not emit those.
Block<1> prepare_block(const RowBlock<1>& W, const Law& law) {
  return prepared<1>(W, law);
}
Block<2> prepare_block(const RowBlock<2>& W, const Law& law) {
  return prepared<2>(W, law);
}
Block<3> prepare_block(const RowBlock<3>& W, const Law& law) {
  return prepared<3>(W, law);
}
Block<5> prepare_block(const RowBlock<5>& W, const Law& law) {
  return prepared<5>(W, law);
}
Block<Eigen::Dynamic> prepare_block(const AnyBlock& W, const Law& law) {
  return prepared<Eigen::Dynamic>(W, law);
}
BlockSolution<1> solve_block(const Block<1>& block, const Rows<1>& q, const Law& law, const Rows<1>& start,
                             LocalSolver solver) {
  return solved<1>(block, q, law, start, solver);
}
BlockSolution<2> solve_block(const Block<2>& block, const Rows<2>& q, const Law& law, const Rows<2>& start,
                             LocalSolver solver) {
  return solved<2>(block, q, law, start, solver);
}
BlockSolution<3> solve_block(const Block<3>& block, const Rows<3>& q, const Law& law, const Rows<3>& start,
                             LocalSolver solver) {
  return solved<3>(block, q, law, start, solver);
}
BlockSolution<5> solve_block(const Block<5>& block, const Rows<5>& q, const Law& law, const Rows<5>& start,
                             LocalSolver solver) {
  return solved<5>(block, q, law, start, solver);
}
BlockSolution<Eigen::Dynamic> solve_block(const Block<Eigen::Dynamic>& block, const AnyRows& q,
                                          const Law& law, const AnyRows& start, LocalSolver solver) {
  return solved<Eigen::Dynamic>(block, q, law, start, solver);
}

}  // namespace aussois
