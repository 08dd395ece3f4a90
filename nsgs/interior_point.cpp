// SPDX-License-Identifier: Apache-2.0
// Primal-dual interior point with Nesterov-Todd scaling (IPM-1) to (IPM-9), De Saxce's term inside of Newton.
// A reference: it forms W and factorises it once per step. Sources: Nesterov and Todd 1997; Vandenberghe
// 2010 (the scaling); Acary, Armand, Nguyen and Shpakovych 2023 (frictional contact).
#include <algorithm>
#include <cmath>
#include <vector>

#include "nsgs/factorised.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr int kPatience = 30;  // steps without halving the best residual
constexpr double kKeptFromBoundary = 0.995;
constexpr double kJammed = 0.1;      // a step shorter than this is followed by one to the centre
constexpr double kProximal = 1e-11;  // on the diagonal of Newton's matrix, where W is singular (IPM-7)
constexpr double kUnscaledBelow =
    1e-5;  // mean product of the cones, of a block's share of |q| squared (IPM-9)

using ConeVec = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;
using ConeMat = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

// |x_1..| <= x_0: the self-dual cone of Lorentz, and its algebra.
double determinant(const ConeVec& x) {  // x.J x, without cancellation
  const double length = x.tail(x.size() - 1).norm();
  return (x[0] - length) * (x[0] + length);
}
ConeVec reflected(ConeVec x) {  // J x
  x.tail(x.size() - 1) *= -1;
  return x;
}
ConeVec product(const ConeVec& x, const ConeVec& y) {
  ConeVec z = x[0] * y + y[0] * x;
  z[0] = x.dot(y);
  return z;
}
ConeVec quotient(const ConeVec& x, const ConeVec& y) {  // z of x o z = y
  const auto n = x.size() - 1;
  const double determinant_x = determinant(x);
  ConeVec z(x.size());
  z[0] = (x[0] * y[0] - x.tail(n).dot(y.tail(n))) / determinant_x;
  z.tail(n) = (y.tail(n) - z[0] * x.tail(n)) / x[0];
  return z;
}
double longest_step(const ConeVec& x, const ConeVec& dx) {  // largest a with x + a dx in the cone
  const auto n = x.size() - 1;
  const double a = dx[0] * dx[0] - dx.tail(n).squaredNorm(), b = x[0] * dx[0] - x.tail(n).dot(dx.tail(n)),
               c = determinant(x);
  double step = dx[0] < 0 ? -x[0] / dx[0] : kInf;
  const double root = b * b - a * c;
  if (root < 0) return step;
  const double s = -(b + std::copysign(std::sqrt(root), b));  // roots of a t^2 + 2 b t + c: s / a and c / s
  for (const double t : {a != 0 ? s / a : kInf, s != 0 ? c / s : kInf})
    if (t > 0) step = std::min(step, t);
  return step;
}

// H p = H^-1 d (IPM-4).
struct Scaled {
  ConeMat H{}, H_inverse{};
  ConeVec lambda{};
};
Scaled nesterov_todd(const ConeVec& p, const ConeVec& d) {
  const auto n = p.size();
  const double size_p = std::sqrt(determinant(p)), size_d = std::sqrt(determinant(d));
  const ConeVec unit_p = p / size_p, unit_d = d / size_d;
  const ConeVec w = (reflected(unit_p) + unit_d) / std::sqrt(2 * (1 + unit_p.dot(unit_d)));
  ConeMat H = ConeMat::Identity(n, n);
  H.row(0) = w.transpose();
  H.col(0) = w;
  const auto tail = w.tail(n - 1);
  H.bottomRightCorner(n - 1, n - 1) += tail * tail.transpose() / (1 + w[0]);
  ConeMat H_inverse = H;
  H_inverse.topRightCorner(1, n - 1) *= -1;
  H_inverse.bottomLeftCorner(n - 1, 1) *= -1;
  const double size = std::sqrt(size_d / size_p);
  Scaled out{.H = size * H, .H_inverse = H_inverse / size};
  out.lambda = out.H * p;
  return out;
}

// Pushed inside where rounding left it on the boundary or beyond.
ConeVec inside(ConeVec x) {
  x[0] = std::max(x[0], x.tail(x.size() - 1).norm() * (1 + 1e-15) + 1e-30);
  return x;
}

// E of p o dd + d o dp = ... without scaling (IPM-9).
ConeMat unscaled_E(const ConeVec& p, const ConeVec& d) {
  ConeMat E(p.size(), p.size());
  for (int j = 0; j < p.size(); ++j) {
    const ConeVec unit = ConeVec::Unit(p.size(), j);
    E.col(j) = quotient(p, product(d, unit));
  }
  return E;
}

// p = (mu r_N + limit, r_first ..) in the cone, d its partner: u^ gets mu d_0 in the normal row and d_1.. in
// the others (IPM-1).
struct Cone {
  int normal = -1;          // row; -1: none
  int first = 0, rows = 0;  // the ball; none for a frictionless normal
  double mu = 1, limit = 0;
  bool shifts = false;  // De Saxce's term of this ball
  bool held = false;    // Newton does not look at the slope of that term (IPM-8)
  ConeVec p{}, d{}, dp{}, dd{}, rhs{};
  Scaled scaled{};
  ConeMat E{};

  int row_of(int i) const { return i == 0 ? normal : first + i - 1; }
  double weight_of(int i) const { return i == 0 ? mu : 1; }
  ConeVec of(const VecX& r, double constant) const {  // P r + constant e_0
    ConeVec x(rows + 1);
    x[0] = (normal >= 0 ? mu * r[normal] : 0) + constant;
    x.tail(rows) = r.segment(first, rows);
    return x;
  }
  ConeVec slope() const {  // (1, -u/|u|) of the shifting normal row, (1, 0) of others (IPM-6)
    ConeVec s = ConeVec::Zero(rows + 1);
    s[0] = 1;
    if (const double speed = d.tail(rows).norm(); shifts && !held && speed > 0)
      s.tail(rows) = -d.tail(rows) / speed;
    return s;
  }
  void add_to(VecX& velocities, const ConeVec& x, const ConeVec& normal_part) const {  // Q^T x
    if (normal >= 0) velocities[normal] += mu * normal_part.dot(x);
    velocities.segment(first, rows) += x.tail(rows);
  }
};

// p o d = 0 linearised at (p, d): rhs = dd + E dp (IPM-5), (IPM-9).
void aim_at_the_boundary(Cone& cone, bool unscaled) {
  if (unscaled) {
    cone.E = unscaled_E(cone.p, cone.d);
    cone.rhs = -quotient(cone.p, product(cone.p, cone.d));
  } else {
    cone.scaled = nesterov_todd(cone.p, cone.d);
    cone.E = cone.scaled.H * cone.scaled.H;
    cone.rhs = -cone.d;
  }
}

// p o d = centre e with the second order of the step before (IPM-8).
void aim_at_the_centre(Cone& cone, double centre, bool unscaled) {
  const Scaled& s = cone.scaled;
  ConeVec aim = unscaled
                    ? ConeVec(product(cone.p, cone.d) + product(cone.dp, cone.dd))
                    : ConeVec(product(s.lambda, s.lambda) + product(s.H * cone.dp, s.H_inverse * cone.dd));
  aim = -aim;
  aim[0] += centre;
  cone.rhs = unscaled ? quotient(cone.p, aim) : ConeVec(s.H * quotient(s.lambda, aim));
}

struct Cones {
  std::vector<Cone> all{};
  std::vector<bool> fixed{};  // rows whose impulse is 0 whatever happens: friction without friction
};

Cones cones_of(const Scaling& problem) {
  Cones out;
  out.fixed.assign(std::size_t(problem.q.size()), false);
  int k = 0;
  for (const Law& law : problem.laws) {
    bool normal_bounded = !has_normal(law);
    for (const Ball& ball : balls(law)) {
      if (!(ball.mu > 0 || ball.limit > 0)) {
        for (int i = 0; i < ball.rows; ++i) out.fixed[k + ball.first + i] = true;
        continue;
      }
      out.all.push_back({.normal = ball.mu > 0 ? k : -1,
                         .first = k + ball.first,
                         .rows = ball.rows,
                         .mu = ball.mu,
                         .limit = ball.limit,
                         .shifts = ball.mu > 0 && problem.model == FrictionModel::coulomb});
      normal_bounded = true;
    }
    if (!normal_bounded) out.all.push_back({.normal = k, .first = k});
    k += law.rows;
  }
  return out;
}

// W + sum Q^T E P (IPM-7), rows and columns of fixed rows those of the identity.
SparseMatrix newton_matrix(const std::vector<Triplet>& W, Eigen::Index size, const Cones& cones) {
  std::vector<Triplet> entries = W;
  const auto add = [&](int i, int j, double value) {
    if (i >= 0 && j >= 0) entries.emplace_back(i, j, value);
  };
  for (const Cone& cone : cones.all) {
    const ConeVec slope = cone.slope();
    for (int j = 0; j <= cone.rows; ++j) {
      const double weight = cone.weight_of(j);
      add(cone.normal, cone.row_of(j), cone.mu * slope.dot(cone.E.col(j)) * weight);
      for (int i = 1; i <= cone.rows; ++i) add(cone.row_of(i), cone.row_of(j), cone.E(i, j) * weight);
    }
  }
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, kProximal);
  SparseMatrix out(size, size);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

std::vector<Triplet> entries_of(const SparseMatrix& W, const std::vector<bool>& fixed) {
  std::vector<Triplet> entries;
  for (int j = 0; j < W.outerSize(); ++j) {
    if (fixed[j]) entries.emplace_back(j, j, 1.0);
    for (SparseMatrix::InnerIterator it(W, j); it; ++it)
      if (!fixed[j] && !fixed[it.row()]) entries.emplace_back(it.row(), j, it.value());
  }
  return entries;
}

// Solves (IPM-5) for dr with the complementarity's right-hand sides of the cones; sets their dp, dd.
VecX direction(const LinearSolve& solve, Cones& cones, const VecX& wrong) {
  VecX rhs = -wrong;
  for (Cone& cone : cones.all) cone.add_to(rhs, cone.rhs, cone.slope());
  for (Eigen::Index i = 0; i < rhs.size(); ++i)
    if (cones.fixed[i]) rhs[i] = 0;
  VecX dr = solve(rhs);
  for (Cone& cone : cones.all) {
    cone.dp = cone.of(dr, 0);
    cone.dd = cone.rhs - cone.E * cone.dp;
  }
  return dr;
}

double longest_step(const Cones& cones) {
  double step = kInf;
  for (const Cone& cone : cones.all)
    step = std::min({step, longest_step(cone.p, cone.dp), longest_step(cone.d, cone.dd)});
  return std::min(1.0, kKeptFromBoundary * step);
}

double mean_product(const Cones& cones, double step) {
  double sum = 0;
  for (const Cone& cone : cones.all) sum += (cone.p + step * cone.dp).dot(cone.d + step * cone.dd);
  return sum / double(std::max<std::size_t>(cones.all.size(), 1));
}

// u + De Saxce's term - u^ with u afresh (IPM-3); zero in fixed rows.
VecX equilibrium(const Cones& cones, VecX u) {
  for (const Cone& cone : cones.all) {
    if (cone.shifts) u[cone.normal] += cone.mu * cone.d.tail(cone.rows).norm();
    ConeVec first = ConeVec::Zero(cone.rows + 1);
    first[0] = 1;
    cone.add_to(u, -cone.d, first);
  }
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (cones.fixed[i]) u[i] = 0;
  return u;
}

}  // namespace

Iterate interior_point(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  BestSoFar best(start, kPatience);
  Cones cones = cones_of(W.scaled);
  const std::vector<Triplet> entries = entries_of(W.matrix(), cones.fixed);
  VecX r = VecX::Zero(W.scaled.q.size());
  const double size = 1 / std::sqrt(double(std::max(W.count(), 1)));  // of a block's share of |q| = 1
  for (const Cone& cone : cones.all)
    if (cone.normal >= 0) r[cone.normal] = size;
  for (Cone& cone : cones.all) {
    cone.p = cone.of(r, cone.limit);
    cone.d = cone.dp = cone.dd = ConeVec::Zero(cone.rows + 1);
    cone.d[0] = size;
  }
  double step = 1;
  report.status = SolveStatus::max_iterations;
  Iterate iterate = judged(W, r, Method::interior_point);
  while (report.iterations < options.max_iterations) {
    ++report.iterations;
    const double mean = mean_product(cones, 0);
    const bool unscaled = mean < kUnscaledBelow * size * size;
    const bool jammed = step < kJammed;
    for (Cone& cone : cones.all) {
      cone.held = jammed;
      aim_at_the_boundary(cone, unscaled);
    }
    const LinearSolve solve = factorised(newton_matrix(entries, r.size(), cones));
    const VecX wrong = equilibrium(cones, iterate.u);
    report.status = SolveStatus::stagnated;
    if (!solve || !wrong.allFinite()) break;
    direction(solve, cones, wrong);
    const double ahead = mean_product(cones, longest_step(cones)) / std::max(mean, 1e-300);
    double centre = std::clamp(ahead * ahead * ahead, 0.0, 1.0) * mean;  // (IPM-8)
    if (jammed) {  // back to the centre, without the second order of a step that was of no use
      centre = mean;
      for (Cone& cone : cones.all) cone.dp.setZero(), cone.dd.setZero();
    }
    for (Cone& cone : cones.all) aim_at_the_centre(cone, centre, unscaled);
    const VecX dr = direction(solve, cones, wrong);
    step = longest_step(cones);
    if (!dr.allFinite()) break;
    r += step * dr;
    for (Cone& cone : cones.all) {
      cone.p = inside(cone.of(r, cone.limit));
      cone.d = inside(cone.d + step * cone.dd);
    }
    report.status = SolveStatus::max_iterations;
    iterate = judged(W, r, Method::interior_point);
    // The iterate itself never touches a bound: the judge also sees its projection (IPM-9).
    const VecX velocities =
        W.scaled.model == FrictionModel::coulomb ? modified_velocities(iterate.u, W.scaled.laws) : iterate.u;
    const Iterate on_bounds =
        judged(W, projected_impulses(r - velocities, W.scaled.laws), Method::interior_point);
    if (best.ends(on_bounds.residual < iterate.residual ? on_bounds : iterate, report.iterations,
                  options.tolerance, report.status))
      break;
  }
  return best.iterate();
}

}  // namespace aussois
