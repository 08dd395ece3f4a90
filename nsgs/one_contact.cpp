// SPDX-License-Identifier: Apache-2.0
#include "nsgs/one_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/LU>

#include "nsgs/law.hpp"

namespace aussois {

namespace {

// A few roundings of W r + q (ONE-6); and a bound, since impulses of 1e15 along the null space of a singular
// W would excuse anything.
constexpr double kLocalTolerance = 3e-14;
constexpr double kLocalBound = 1e-6;
// Quadratic near the answer; more only where it cycles, and then enumeration is quicker
constexpr int kNewtonSteps = 20;

struct Candidate {
  Vec3 r = Vec3::Zero();
  double wrong = kInf;  // natural map
  double allowed = 0;
};

// One contact without units: trace(W) = 3, |q| = 1.
struct Block {
  Mat3 W = Mat3::Identity();
  Vec3 q = Vec3::Zero();
  double mu = 0;

  Candidate judged(const Vec3& r) const {
    const Vec3 u = W * r + q;
    const double wrong = (r - project<3>(coulomb(mu), r - modified_velocity<3>(coulomb(mu), u))).norm();
    const double allowed = std::min(kLocalTolerance * (1 + W.norm() * r.norm()), kLocalBound);
    return {r, std::isfinite(wrong) ? wrong : kInf, allowed};
  }
};

bool good(const Candidate& c) {
  return c.wrong <= c.allowed;
}
const Candidate& better(const Candidate& a, const Candidate& b) {
  return b.wrong < a.wrong ? b : a;
}

double largest_eigenvalue(const Mat2& A) {  // of the symmetric part
  const double mean = (A(0, 0) + A(1, 1)) / 2;
  return mean + std::hypot((A(0, 0) - A(1, 1)) / 2, (A(0, 1) + A(1, 0)) / 2);
}

// r = project_coulomb(r - rho u) by Newton (ONE-2), (ONE-3).
Candidate newton(const Block& block, const Vec3& r_start) {
  const double rho_n = 1 / block.W(0, 0);
  const double rho_t = 1 / std::max(largest_eigenvalue(block.W.bottomRightCorner<2, 2>()), 1e-300);
  const Vec3 rho(rho_n, rho_t, rho_t);
  const Mat3 I_minus_rho_W = Mat3::Identity() - rho.asDiagonal() * block.W;
  Candidate best = block.judged(r_start);
  Vec3 r = r_start;
  for (int step = 0; step < kNewtonSteps && !good(best); ++step) {
    const Vec3 y = I_minus_rho_W * r - rho.cwiseProduct(block.q);
    const Mat3 J = Mat3::Identity() - answer_derivative<3>(coulomb(block.mu), y) * I_minus_rho_W;
    Mat3 inverse;
    bool regular = false;
    J.computeInverseWithCheck(inverse, regular, 1e-300);
    if (!regular) break;
    r -= inverse * (r - answer<3>(coulomb(block.mu), y));
    if (!r.allFinite()) break;
    best = better(best, block.judged(r));
  }
  return best;
}

// Coefficients c0 + c1 x + ... of a real polynomial of degree at most 4.
using Polynomial = std::array<double, 5>;

double value(const Polynomial& c, double x) {
  return (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
}

Polynomial derivative(const Polynomial& c) {
  return {c[1], 2 * c[2], 3 * c[3], 4 * c[4], 0};
}

// Bisection down to neighbouring numbers: slower than Newton, never wrong.
double bisect(const Polynomial& c, double low, double high) {
  const bool rising = value(c, low) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::midpoint(low, high);
    if (middle == low || middle == high) break;
    ((value(c, middle) < 0) == rising ? low : high) = middle;
  }
  return std::midpoint(low, high);
}

struct Abscissae {
  std::array<double, 16> x{};
  int count = 0;
  void add(double value) { x[std::size_t(count++)] = value; }
};

// Real roots in [-bound, bound], ascending: between two neighbouring roots of the derivative lies at most
// one. With `with_extrema` the extrema themselves are listed too: a double root shows there and nowhere else.
Abscissae real_roots(const Polynomial& c, int degree, double bound, bool with_extrema) {
  Abscissae roots;
  if (degree == 0) return roots;
  const Abscissae extrema = real_roots(derivative(c), degree - 1, bound, false);
  double low = -bound;
  for (int i = 0; i <= extrema.count; ++i) {
    const double high = i < extrema.count ? extrema.x[std::size_t(i)] : bound;
    if ((value(c, low) < 0) != (value(c, high) < 0)) roots.add(bisect(c, low, high));
    if (with_extrema && i < extrema.count) roots.add(high);
    low = high;
  }
  return roots;
}

// The slip condition t x u_T = 0 as a quadratic form in the slip direction t (ONE-4): k . t + t . Q t = 0.
struct SlipCondition {
  Vec2 k = Vec2::Zero();
  Mat2 Q = Mat2::Zero();
  double operator()(const Vec2& t) const { return k.dot(t) + t.dot(Q * t); }
};

SlipCondition slip_condition(const Block& block) {
  const Mat3& W = block.W;
  const Vec2 q_t = block.q.tail<2>();
  const Vec2 constant = q_t * W(0, 0) - block.q[0] * W.block<2, 1>(1, 0);
  const Mat2 linear = block.mu * (block.q[0] * W.bottomRightCorner<2, 2>() - q_t * W.block<1, 2>(0, 1));
  Mat2 turn;  // t x b = t . (turn b)
  turn << 0, 1, -1, 0;
  return {turn * constant, turn * linear};
}

// The slip of direction t (ONE-5): r_N from u_N = 0, r_T against t. Nothing if the wall would have to pull.
Candidate slip_along(const Block& block, const Vec2& t) {
  const double d = block.W(0, 0) - block.mu * block.W.block<1, 2>(0, 1).dot(t);
  const double r_n = -block.q[0] / d;
  if (!(r_n >= 0)) return {};
  return block.judged({r_n, -block.mu * r_n * t[0], -block.mu * r_n * t[1]});
}

// Directions of slip: the quartic in z = tan(angle / 2), its origin turned so that no root lies near infinity
// (ONE-4).
Candidate slip(const Block& block) {
  const SlipCondition condition = slip_condition(block);
  Vec2 far(1, 0);
  for (int i = 0; i < 8; ++i) {
    const Vec2 t(std::cos(i * kPi / 4), std::sin(i * kPi / 4));
    if (std::abs(condition(t)) > std::abs(condition(far))) far = t;
  }
  Mat2 R;  // the first axis is the direction opposite to `far`, which is z = infinity
  R << -far[0], far[1], -far[1], -far[0];
  const Vec2 k = R.transpose() * condition.k;
  const Mat2 Q = R.transpose() * condition.Q * R;
  const double b = Q(0, 1) + Q(1, 0);
  const Polynomial quartic{k[0] + Q(0, 0), 2 * (k[1] + b), 4 * Q(1, 1) - 2 * Q(0, 0), 2 * (k[1] - b),
                           Q(0, 0) - k[0]};
  const double leading = std::abs(quartic[4]);
  if (leading == 0) return slip_along(block, Vec2(-far));  // every direction will do
  double bound = 0;                                        // Cauchy's
  for (int i = 0; i < 4; ++i) bound = std::max(bound, 1 + std::abs(quartic[std::size_t(i)]) / leading);
  const Abscissae roots = real_roots(quartic, 4, bound, true);
  Candidate best;
  for (int i = 0; i < roots.count; ++i) {
    const double z = roots.x[std::size_t(i)];
    const Vec2 t = R * Vec2(1 - z * z, 2 * z) / (1 + z * z);
    best = better(best, slip_along(block, t));
  }
  return best;
}

// Separation is dealt with before; stick, slip, and the better of the two polished by Newton.
Candidate enumerate(const Block& block) {
  const Eigen::FullPivLU<Mat3> lu(block.W);
  Candidate stick = block.judged(lu.solve(-block.q));
  if (good(stick)) return stick;
  const Candidate best = better(stick, slip(block));
  return good(best) || !std::isfinite(best.wrong) ? best : better(best, newton(block, best.r));
}

}  // namespace

LocalSolution solve_one_contact(const Mat3& W, const Vec3& q, double mu, const Vec3& r_start,
                                LocalSolver solver) {
  const double w = W.trace() / 3, size = q.norm();
  if (!(W.allFinite() && std::isfinite(size) && w > 0 && std::isfinite(w))) return {.solved = false};
  if (q[0] >= 0) return {};  // separation (ONE-1)
  const Block block{W / w, q / size, mu};
  const double unit = size / w;
  const Law law = coulomb(mu);
  const Vec3 start = r_start.allFinite() ? answer<3>(law, Vec3(r_start / unit)) : Vec3(Vec3::Zero());

  if (solver == LocalSolver::projection) {
    const double rho = 1 / std::max(block.W(0, 0), largest_eigenvalue(block.W.bottomRightCorner<2, 2>()));
    const Vec3 r = project<3>(law, start - rho * modified_velocity<3>(law, Vec3(block.W * start + block.q)));
    return {.r = r * unit, .solved = good(block.judged(r))};
  }
  Candidate answer;
  bool fail_safe = false;
  if (solver != LocalSolver::enumerative) {
    const Vec3 frictionless(-block.q[0] / block.W(0, 0), 0, 0);
    answer = newton(block, start[0] > 0 || !frictionless.allFinite() ? start : frictionless);
  }
  if (solver == LocalSolver::enumerative || (solver == LocalSolver::hybrid && !good(answer))) {
    fail_safe = solver == LocalSolver::hybrid;
    answer = better(answer, enumerate(block));
  }
  return {.r = answer.r * unit, .solved = good(answer), .fail_safe = fail_safe};
}

}  // namespace aussois
