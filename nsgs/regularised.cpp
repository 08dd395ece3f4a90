// SPDX-License-Identifier: Apache-2.0
#include "nsgs/regularised.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "nsgs/residual.hpp"

namespace aussois {
namespace {

constexpr int kMemory = 10;        // of Anderson's acceleration (AA-1)
constexpr int kGuesses = 20;       // of which contacts are closed
constexpr int kMostSweeps = 1000;  // on a dense matrix
constexpr double kStill = 0.1;  // of the tolerance: a sweep that moves less than this of lambda is the last
constexpr int kFewRows = 320;   // a dense factor of as many costs no more than a hundred sweeps

void check(const LocalProblem& problem, const VecX& R) {
  validate(problem);
  for (std::size_t c = 0; c < problem.laws.size(); ++c)
    require(problem.laws[c].kind == LawKind::coulomb || problem.laws[c].kind == LawKind::unilateral,
            "laws[" + std::to_string(c) + "].kind = " + to_string(problem.laws[c].kind) +
                " must be coulomb or unilateral");
  const std::string bound = "be " + std::to_string(problem.q.size()) + ", the rows of laws";
  require_field(R.size() == problem.q.size(), "R.size()", R.size(), bound.c_str());
  for (const double r : R) require_field(r >= 0, "R", r, "be at least 0 1/kg");
}

SolverOptions options_of(const RegularisedOptions& options, int done = 0) {
  SolverOptions out{
      .tolerance = options.tolerance,
      .max_iterations = done > 0 ? std::max(1, options.max_iterations - done) : options.max_iterations};
  switch (options.reading) {
    case FrictionReading::coulomb_pgs:
      out.method = Method::coulomb_pgs;
      out.anderson = kMemory;
      break;
    case FrictionReading::convex_cone:
      out.method = Method::interior_point;
      out.model = FrictionModel::convex_cone;
      break;
    case FrictionReading::hybrid:
      break;
  }
  return out;
}

// A + R, or its symmetric part.
SparseMatrix compliant(const LocalProblem& problem, const VecX& R, FrictionReading reading) {
  SparseMatrix W = problem.W;
  if (reading == FrictionReading::convex_cone) W = 0.5 * (W + SparseMatrix(problem.W.transpose()));
  return W + SparseMatrix(R.asDiagonal());
}

// Of the nearest point of the cone (LAW-5), away from its kinks.
AnyBlock projection_derivative(const Law& law, const AnyRows& y) {
  const Eigen::Index tangents = y.size() - 1;
  const double length = y.tail(tangents).norm(), mu = law.mu;
  AnyBlock D = AnyBlock::Identity(y.size(), y.size());
  if (y[0] >= 0 && length <= mu * y[0]) return D;
  const double normal = (y[0] + mu * length) / (1 + mu * mu);
  D.setZero();
  if (normal <= 0) return D;
  const AnyRows t = y.tail(tangents) / length;
  AnyRows ray(y.size());  // of the cone; the projection is normal * ray
  ray << 1, mu * t;
  D = ray * ray.transpose() / (1 + mu * mu);
  D.bottomRightCorner(tangents, tangents) +=
      mu * normal / length * (AnyBlock::Identity(tangents, tangents) - t * t.transpose());
  return D;
}

// The answer if every contact sticks or is open, the same for all readings (REG-11); empty if not.
VecX stick_or_open(const MatX& W, const LocalProblem& problem) {
  const std::vector<int> first = first_rows(problem.laws);
  const std::size_t count = problem.laws.size();
  std::vector<char> closed(count, 1);
  for (int guess = 0; guess < kGuesses; ++guess) {
    std::vector<int> rows;
    for (std::size_t c = 0; c < count; ++c)
      for (int i = 0; closed[c] && i < problem.laws[c].rows; ++i) rows.push_back(first[c] + i);
    VecX lambda = VecX::Zero(W.rows());
    const VecX pushed = -problem.q(rows);
    if (!rows.empty()) lambda(rows) = VecX(MatX(W(rows, rows)).partialPivLu().solve(pushed));
    const VecX w = W * lambda + problem.q;
    bool same = true;
    for (std::size_t c = 0; c < count; ++c) {
      const char now = closed[c] ? lambda[first[c]] > 0 : w[first[c]] < 0;
      same = same && now == closed[c];
      closed[c] = now;
    }
    if (!same) continue;
    for (std::size_t c = 0; c < count; ++c) {
      const Law& law = problem.laws[c];
      if (lambda.segment(first[c] + 1, law.rows - 1).norm() > law.mu * lambda[first[c]]) return {};
    }
    return lambda;
  }
  return {};
}

// (REG-6) on a dense matrix, up to `most` sweeps or until none moves lambda by more than `small` of it.
// Returns their number.
int sweep(const MatX& W, const LocalProblem& problem, double small, int most, VecX& lambda) {
  const std::vector<int> first = first_rows(problem.laws);
  const std::size_t count = problem.laws.size();
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = W;
  VecX step(W.rows());  // inverse curvature of the normal row, and of the tangential ones together
  for (std::size_t c = 0; c < count; ++c) {
    const Eigen::Index k = first[c], tangents = problem.laws[c].rows - 1;
    step[k] = 1 / W(k, k);
    if (tangents == 0) continue;
    const MatX T = W.block(k + 1, k + 1, tangents, tangents);
    const double mean = T.trace() / double(tangents), shear = 0.5 * (T(0, tangents - 1) + T(tangents - 1, 0));
    const double largest = tangents == 1 ? mean : mean + std::hypot(0.5 * (T(0, 0) - T(1, 1)), shear);
    step.segment(k + 1, tangents).setConstant(1 / largest);
  }
  for (int done = 1; done <= most; ++done) {
    double moved = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const Eigen::Index k = first[c], tangents = problem.laws[c].rows - 1;
      const double normal = std::max(0.0, lambda[k] - step[k] * (rows.row(k).dot(lambda) + problem.q[k]));
      moved = std::max(moved, std::abs(normal - lambda[k]));
      lambda[k] = normal;
      if (tangents == 0) continue;
      Vec2 t = Vec2::Zero();
      for (Eigen::Index i = 0; i < tangents; ++i)
        t[i] = lambda[k + 1 + i] - step[k + 1 + i] * (rows.row(k + 1 + i).dot(lambda) + problem.q[k + 1 + i]);
      const double length = t.norm(), radius = problem.laws[c].mu * normal;
      if (length > radius) t *= radius / length;
      for (Eigen::Index i = 0; i < tangents; ++i) {
        moved = std::max(moved, std::abs(t[i] - lambda[k + 1 + i]));
        lambda[k + 1 + i] = t[i];
      }
    }
    if (!(moved > small * lambda.cwiseAbs().maxCoeff())) return done;
  }
  return most;
}

// Of problems with few rows: the answer, or nearly, without a sparse method.
struct Start {
  VecX lambda{};
  int sweeps = 0;
};
Start dense_start(const LocalProblem& soft, const VecX& lambda_0, const RegularisedOptions& options) {
  const MatX W = soft.W;
  if (VecX guess = stick_or_open(W, soft); guess.size() > 0) return {std::move(guess)};
  if (options.reading != FrictionReading::coulomb_pgs || !(W.diagonal().minCoeff() > 0)) return {lambda_0};
  Start start{lambda_0.size() > 0 ? lambda_0 : VecX(VecX::Zero(soft.q.size()))};
  start.sweeps =
      sweep(W, soft, kStill * options.tolerance, std::min(options.max_iterations, kMostSweeps), start.lambda);
  return start;
}

}  // namespace

const char* to_string(FrictionReading reading) {
  return name_of(reading, kFrictionReadings);
}

void describe(SettingVisitor& visit, RegularisedOptions& o) {
  visit.begin("RegularisedOptions");
  visit.choice({"reading", "how friction is treated"}, o.reading, kFrictionReadings);
  visit.number({"tolerance", "tolerance on the scaled residual", "-", open_range(0, 1)}, o.tolerance);
  visit.count({"max_iterations", "maximum number of sweeps or steps", "", range_from(1)}, o.max_iterations);
}

VecX regularisation(const LocalProblem& problem, double rho) {
  validate(problem);
  require_field(rho >= 0, "rho", rho, "be at least 0");
  return rho * row_scales(problem.W.diagonal(), problem.laws);
}

VecX with_restitution(VecX v_free, const VecX& v, const std::vector<Law>& laws, double e, double threshold) {
  require_field(e >= 0 && e <= 1, "e", e, "lie in [0, 1]");
  const std::vector<int> first = first_rows(laws);
  require(v_free.size() == first.back() && v.size() == first.back(),
          "v_free.size() = " + std::to_string(v_free.size()) + " and v.size() = " + std::to_string(v.size()) +
              " must be " + std::to_string(first.back()) + ", the rows of laws");
  for (std::size_t c = 0; c < laws.size(); ++c)
    if (has_normal(laws[c]) && v[first[c]] < -threshold) v_free[first[c]] += e * v[first[c]];
  return v_free;
}

RegularisedSolution solve_regularised(const LocalProblem& problem, const VecX& R, const VecX& lambda_0,
                                      const RegularisedOptions& options) {
  check(problem, R);
  const LocalProblem soft{compliant(problem, R, options.reading), problem.q, problem.laws};
  check_ranges(options);
  Start start{lambda_0};
  const bool dense = problem.q.size() > 0 && problem.q.size() <= kFewRows;
  if (dense && problem.q.allFinite() && lambda_0.allFinite() &&
      (lambda_0.size() == 0 || lambda_0.size() == problem.q.size()))
    start = dense_start(soft, lambda_0, options);
  FrictionSolution found = solve(soft, start.lambda, options_of(options, start.sweeps));
  found.report.iterations += start.sweeps;
  RegularisedSolution out{.v = problem.W * found.r + problem.q, .report = found.report};
  const std::vector<int> first = first_rows(problem.laws);
  for (std::size_t c = 0; c < problem.laws.size(); ++c)
    out.violation = std::max(out.violation, R[first[c]] * found.r[first[c]]);
  out.lambda = std::move(found.r);
  return out;
}

// lambda = P(lambda - D w) with w = W lambda + b and one positive number per block in D, so
// (1 - P' + P' D W) d lambda = -P' D d b.
MatX impulse_sensitivity(const LocalProblem& problem, const VecX& R, const VecX& lambda,
                         FrictionReading reading) {
  check(problem, R);
  require_field(lambda.size() == problem.q.size(), "lambda.size()", lambda.size(),
                "be the number of rows of laws");
  const MatX W = compliant(problem, R, reading);
  const VecX step = row_scales(W.diagonal(), problem.laws).cwiseInverse();
  const VecX y = lambda - step.cwiseProduct(W * lambda + problem.q);
  const std::vector<int> first = first_rows(problem.laws);
  MatX P = MatX::Zero(W.rows(), W.rows());
  for (std::size_t c = 0; c < problem.laws.size(); ++c) {
    const Law& law = problem.laws[c];
    const AnyRows y_c = y.segment(first[c], law.rows);
    P.block(first[c], first[c], law.rows, law.rows) = reading == FrictionReading::convex_cone
                                                          ? projection_derivative(law, y_c)
                                                          : answer_derivative<Eigen::Dynamic>(law, y_c);
  }
  const MatX PD = P * step.asDiagonal();
  return (MatX::Identity(W.rows(), W.rows()) - P + PD * W).partialPivLu().solve(-PD);
}

}  // namespace aussois
