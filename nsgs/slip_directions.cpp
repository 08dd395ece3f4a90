// SPDX-License-Identifier: Apache-2.0
#include "nsgs/slip_directions.hpp"

#include <cmath>
#include <numeric>

namespace aussois {

namespace {

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

SlipCondition slip_condition(const Mat3& W, const Vec3& q, double mu) {
  const Vec2 q_t = q.tail<2>();
  const Vec2 constant = q_t * W(0, 0) - q[0] * W.block<2, 1>(1, 0);
  const Mat2 linear = mu * (q[0] * W.bottomRightCorner<2, 2>() - q_t * W.block<1, 2>(0, 1));
  Mat2 turn;  // t x b = t . (turn b)
  turn << 0, 1, -1, 0;
  return {turn * constant, turn * linear};
}

// The slip of direction t (ONE-5): r_N from u_N = 0, r_T against t. Nothing if the wall would have to pull.
void add_slip(const Mat3& W, const Vec3& q, double mu, const Vec2& t, SlipCandidates& out) {
  const double r_n = -q[0] / (W(0, 0) - mu * W.block<1, 2>(0, 1).dot(t));
  if (r_n >= 0 && std::isfinite(r_n))
    out.r[std::size_t(out.count++)] = {r_n, -mu * r_n * t[0], -mu * r_n * t[1]};
}

}  // namespace

// The quartic in z = tan(angle / 2), its origin turned so that no root lies near infinity (ONE-4).
SlipCandidates slip_candidates(const Mat3& W, const Vec3& q, double mu) {
  const SlipCondition condition = slip_condition(W, q, mu);
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
  SlipCandidates out;
  if (leading == 0) {  // every direction will do
    add_slip(W, q, mu, -far, out);
    return out;
  }
  double bound = 0;  // Cauchy's
  for (int i = 0; i < 4; ++i) bound = std::max(bound, 1 + std::abs(quartic[std::size_t(i)]) / leading);
  const Abscissae roots = real_roots(quartic, 4, bound, true);
  for (int i = 0; i < roots.count; ++i) {
    const double z = roots.x[std::size_t(i)];
    const Vec2 t = R * Vec2(1 - z * z, 2 * z) / (1 + z * z);
    add_slip(W, q, mu, t, out);
  }
  return out;
}

}  // namespace aussois
