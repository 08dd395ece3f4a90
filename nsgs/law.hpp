// SPDX-License-Identifier: Apache-2.0
// The law of one block of rows (LAW-1) to (LAW-9): which impulses it allows and which velocities it demands.
// Rows of a block: normal first, then tangents, then moments. All functions are Euclidean: they assume rows
// of one size, as Scaling makes them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/types.hpp"

namespace aussois {

enum class LawKind : std::uint8_t {
  coulomb,       // 2 or 3 rows (N, T) or (N, T, T): 0 <= u_N perp r_N >= 0, |r_T| <= mu r_N against u_T
  rolling,       // 5 rows (N, T, T, R, R): coulomb, and |r_R| <= mu_r r_N against u_R
  contensou,     // 4 rows (N, T, T, drilling): |(r_T, r_D / radius)| <= mu r_N against (u_T, radius u_D)
  unilateral,    // 1 row: 0 <= u perp r >= 0, a frictionless contact or the stop of a joint
  bilateral,     // 1 to 6 rows: u = 0
  dry_friction,  // 1 row: |r| <= limit against u
};
const char* to_string(LawKind kind);

struct Law {
  LawKind kind = LawKind::coulomb;
  int rows = 3;
  double mu = 0;      // coulomb, rolling, contensou [-], >= 0
  double mu_r = 0;    // rolling [m], >= 0
  double radius = 1;  // contensou: friction moment / (mu r_N) [m], > 0
  double limit = 0;   // dry_friction [N s or N m s], >= 0
};

inline Law coulomb(double mu) {
  return {.mu = mu};
}
inline Law coulomb_2d(double mu) {
  return {.rows = 2, .mu = mu};
}
inline Law rolling(double mu, double mu_r) {
  return {.kind = LawKind::rolling, .rows = 5, .mu = mu, .mu_r = mu_r};
}
inline Law contensou(double mu, double radius) {
  return {.kind = LawKind::contensou, .rows = 4, .mu = mu, .radius = radius};
}
inline Law unilateral() {
  return {.kind = LawKind::unilateral, .rows = 1};
}
inline Law bilateral(int rows) {
  return {.kind = LawKind::bilateral, .rows = rows};
}
inline Law dry_friction(double limit) {
  return {.kind = LawKind::dry_friction, .rows = 1, .limit = limit};
}

/// Throws std::invalid_argument naming laws[index] and its field unless the rows fit the kind and the numbers
/// their bounds.
void validate(const Law& law, std::size_t index);

inline constexpr int kMaxRows = 6;
/// The rows of one block; R = Eigen::Dynamic: as many as the law has.
template <int R>
using Rows = Eigen::Matrix<double, R, 1, 0, R == Eigen::Dynamic ? kMaxRows : R, 1>;
template <int R>
using RowBlock =
    Eigen::Matrix<double, R, R, 0, R == Eigen::Dynamic ? kMaxRows : R, R == Eigen::Dynamic ? kMaxRows : R>;
using AnyRows = Rows<Eigen::Dynamic>;
using AnyBlock = RowBlock<Eigen::Dynamic>;

/// The rows first .. first + rows - 1 of a block lie in a ball of radius mu r_N + limit (LAW-2).
struct Ball {
  int first = 0, rows = 0;
  double mu = 0, limit = 0;
};
struct Balls {
  std::array<Ball, 2> ball{};
  int count = 0;
  const Ball* begin() const { return ball.data(); }
  const Ball* end() const { return ball.data() + count; }
};
inline Balls balls(const Law& law) {
  switch (law.kind) {
    case LawKind::coulomb:
      return {{Ball{1, law.rows - 1, law.mu, 0}}, 1};
    case LawKind::rolling:
      return {{Ball{1, 2, law.mu, 0}, Ball{3, 2, law.mu_r, 0}}, 2};
    case LawKind::contensou:
      return {{Ball{1, 3, law.mu, 0}}, 1};
    case LawKind::dry_friction:
      return {{Ball{0, 1, 0, law.limit}}, 1};
    case LawKind::unilateral:
    case LawKind::bilateral:
      break;
  }
  return {};
}
inline bool has_normal(const Law& law) {  // r_0 >= 0
  return law.kind != LawKind::bilateral && law.kind != LawKind::dry_friction;
}

template <int R>
double length_in(const Ball& ball, const Rows<R>& y) {
  if constexpr (R == 1) return ball.first == 0 ? std::abs(y[0]) : 0;
  double sum = 0;
  for (int i = ball.first; i < ball.first + ball.rows; ++i) sum += y[i] * y[i];
  return std::sqrt(sum);
}
template <int R>
void stretch_in(const Ball& ball, double factor, Rows<R>& y) {
  if constexpr (R == 1)
    y[0] *= ball.first == 0 ? factor : 1;
  else
    for (int i = ball.first; i < ball.first + ball.rows; ++i) y[i] *= factor;
}

/// |y_T| of a coulomb block.
template <int R>
double tangential_length(const Law& law, const Rows<R>& y) {
  if constexpr (R == 1)
    return 0;
  else if constexpr (R == 2)
    return std::abs(y[1]);
  else
    return law.rows == 2 ? std::abs(y[1]) : std::sqrt(y[1] * y[1] + y[2] * y[2]);
}

/// Which law holds between impulses and velocities.
enum class FrictionModel : std::uint8_t {
  coulomb,      // with De Saxce's term: a slipping contact does not lift off
  convex_cone,  // without it: convex, as in Chrono and MuJoCo; a slipping contact lifts off at mu |u_T|
};

/// De Saxce's modified velocity (LAW-4): u_N grows by mu |u_T| for every ball.
template <int R>
Rows<R> modified_velocity(const Law& law, Rows<R> u) {
  if (law.kind == LawKind::unilateral) return u;
  if (R != 1 && law.kind == LawKind::coulomb) {  // the most frequent case, without a list of balls
    u[0] += law.mu * tangential_length<R>(law, u);
    return u;
  }
  for (const Ball& ball : balls(law))
    if (ball.mu > 0) u[0] += ball.mu * length_in<R>(ball, u);
  return u;
}

/// project() of the laws that are less frequent; not inlined, so that those below are.
template <int R>
[[gnu::noinline]] Rows<R> project_on_balls(const Law& law, Rows<R> r) {
  const Balls all = balls(law);
  if (!has_normal(law)) {
    for (const Ball& ball : all) {
      const double length = length_in<R>(ball, r);
      if (length > ball.limit) stretch_in<R>(ball, ball.limit / length, r);
    }
    return r;
  }
  // r_N of the projection, first as if every ball were exceeded; a ball that turns out not to be is left out
  // for good
  double length[2] = {0, 0}, normal = 0;
  bool exceeded[2] = {false, false};
  for (int g = 0; g < all.count; ++g) {
    length[g] = length_in<R>(all.ball[g], r);
    exceeded[g] = true;
  }
  for (bool again = true; again;) {
    again = false;
    double sum = r[0], weight = 1;
    for (int g = 0; g < all.count; ++g)
      if (exceeded[g]) {
        const double mu = all.ball[g].mu;
        sum += mu * length[g];
        weight += mu * mu;
      }
    normal = std::max(sum / weight, 0.0);
    for (int g = 0; g < all.count; ++g)
      if (exceeded[g] && length[g] <= all.ball[g].mu * normal) {
        exceeded[g] = false;
        again = true;
      }
  }
  r[0] = normal;
  for (int g = 0; g < all.count; ++g) {
    const Ball& ball = all.ball[g];
    if (exceeded[g]) stretch_in<R>(ball, ball.mu * normal / length[g], r);
  }
  return r;
}

/// The nearest impulse that the law allows (LAW-5).
template <int R>
Rows<R> project(const Law& law, Rows<R> r) {
  if (law.kind == LawKind::unilateral) {
    r[0] = std::max(r[0], 0.0);
    return r;
  }
  if (R != 1 && law.kind == LawKind::coulomb) {
    const double length = tangential_length<R>(law, r);
    if (r[0] >= 0 && length <= law.mu * r[0]) return r;
    const double normal = (r[0] + law.mu * length) / (1 + law.mu * law.mu);
    if (normal <= 0) return Rows<R>::Zero(r.size());
    r[0] = normal;
    for (int i = 1; i < law.rows; ++i) r[i] *= law.mu * normal / length;
    return r;
  }
  return project_on_balls<R>(law, r);
}

/// (LAW-6): the normal part alone is made non-negative, then every ball is shortened to its radius. This is
/// the answer of a block whose compliance is the same in every row. It is not the nearest point of the set:
/// friction does not push back on the normal.
template <int R>
Rows<R> block_answer(const Law& law, Rows<R> y) {
  if (has_normal(law) && !(y[0] > 0)) return Rows<R>::Zero(y.size());
  if (R != 1 && law.kind == LawKind::coulomb) {
    const double radius = law.mu * y[0], length = tangential_length<R>(law, y);
    for (int i = 1; length > radius && i < law.rows; ++i) y[i] *= radius / length;
    return y;
  }
  for (const Ball& ball : balls(law)) {
    const double radius = ball.mu * y[0] + ball.limit, length = length_in<R>(ball, y);
    if (length > radius) stretch_in<R>(ball, radius / length, y);
  }
  return y;
}

/// One element of the generalised derivative of `block_answer` (LAW-7).
template <int R>
RowBlock<R> answer_derivative(const Law& law, const Rows<R>& y) {
  if (has_normal(law) && !(y[0] > 0)) return RowBlock<R>::Zero(y.size(), y.size());
  RowBlock<R> D = RowBlock<R>::Identity(y.size(), y.size());
  for (const Ball& ball : balls(law)) {
    const double radius = ball.mu * y[0] + ball.limit, length = length_in<R>(ball, y);
    if (length <= radius) continue;
    for (int i = ball.first; i < ball.first + ball.rows; ++i) {
      const double along = y[i] / length;
      for (int j = ball.first; j < ball.first + ball.rows; ++j)
        D(i, j) = radius / length * ((i == j) - along * y[j] / length);
      if (ball.mu > 0) D(i, 0) = ball.mu * along;
    }
  }
  return D;
}

}  // namespace aussois
