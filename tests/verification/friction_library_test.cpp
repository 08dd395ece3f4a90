// SPDX-License-Identifier: Apache-2.0
// Is every problem of the shared friction library solved? The judge here shares nothing with the solvers: it
// computes velocities from the impulses and the file's matrices alone, and projects in another way.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include <Eigen/SparseLU>
#include <gtest/gtest.h>

#include "io/fclib_file.hpp"
#include "nsgs/solve.hpp"

namespace aussois {
namespace {

struct Judged {
  VecX u{}, q{};
  std::vector<double> w{};  // diagonal of W
};

Judged judge(const FclibFile& file, const VecX& r) {
  Judged out;
  if (const LocalProblem* local = std::get_if<LocalProblem>(&file.problem)) {
    out.u = local->W * r + local->q;
    out.q = local->q;
    for (Eigen::Index i = 0; i < r.size(); ++i) out.w.push_back(local->W.coeff(i, i));
    return out;
  }
  const FrictionProblem& global = std::get<FrictionProblem>(file.problem);
  const Eigen::SparseLU<SparseMatrix> lu(global.M);
  out.u = global.H.transpose() * VecX(lu.solve(global.H * r + global.f)) + global.w;
  out.q = global.H.transpose() * VecX(lu.solve(global.f)) + global.w;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const VecX column = global.H.col(i);
    out.w.push_back(column.dot(VecX(lu.solve(column))));
  }
  return out;
}

// The projection on { |t| <= mu n, |m| <= nu n } by bisection on n, where the distance's derivative changes
// sign.
std::vector<double> nearest(const std::vector<double>& x, double mu, double nu, std::size_t tangents) {
  const auto length = [&](std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) sum += x[i] * x[i];
    return std::sqrt(sum);
  };
  const double t = length(1, 1 + tangents), m = length(1 + tangents, x.size());
  const auto slope = [&](double n) {
    return n - x[0] - mu * std::max(t - mu * n, 0.0) - nu * std::max(m - nu * n, 0.0);
  };
  double low = 0, high = std::abs(x[0]) + mu * t + nu * m + 1e-300;
  for (int i = 0; i < 200 && slope(low) < 0; ++i) {
    const double middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    (slope(middle) < 0 ? low : high) = middle;
  }
  const double n = slope(0) >= 0 ? 0 : (low + high) / 2;
  std::vector<double> p{n};
  for (std::size_t i = 1; i < x.size(); ++i) {
    const bool tangent = i <= tangents;
    const double size = tangent ? t : m, radius = (tangent ? mu : nu) * n;
    p.push_back(size <= radius ? x[i] : x[i] * radius / size);
  }
  return p;
}

// err_scaled; `by_kind`: rolling rows with a scale of their own (decision record 0012) or one for all rows.
double scaled_error(const Judged& judged, const VecX& r, const std::vector<Law>& laws, bool by_kind) {
  double wrong = 0, size = 0;
  Eigen::Index k = 0;
  for (const Law& law : laws) {
    const auto rows = std::size_t(law.rows), tangents = std::min<std::size_t>(rows - 1, 2);
    const auto mean = [&](std::size_t from, std::size_t to) {
      double sum = 0;
      for (std::size_t i = from; i < to; ++i) sum += judged.w[std::size_t(k) + i];
      return sum / double(to - from);
    };
    std::vector<double> s(rows, 1 / std::sqrt(mean(0, by_kind ? 1 + tangents : rows)));
    if (by_kind && rows == 5) s[3] = s[4] = 1 / std::sqrt(mean(3, 5));
    std::vector<double> r_c, u_c;
    for (std::size_t i = 0; i < rows; ++i) {
      r_c.push_back(r[k + long(i)] / s[i]);
      u_c.push_back(judged.u[k + long(i)] * s[i]);
      size += std::pow(judged.q[k + long(i)] * s[i], 2);
    }
    const double mu = law.mu, nu = rows == 5 ? law.mu_r * s[0] / s[3] : 0;
    const double slip = rows == 2 ? std::abs(u_c[1]) : std::hypot(u_c[1], u_c[2]);
    u_c[0] += mu * slip + (rows == 5 ? nu * std::hypot(u_c[3], u_c[4]) : 0);
    std::vector<double> x;
    for (std::size_t i = 0; i < rows; ++i) x.push_back(r_c[i] - u_c[i]);
    const std::vector<double> p = nearest(x, mu, nu, tangents);
    for (std::size_t i = 0; i < rows; ++i) wrong += std::pow(r_c[i] - p[i], 2);
    k += law.rows;
  }
  return std::sqrt(wrong / size);
}

class Library : public ::testing::TestWithParam<double> {};

TEST_P(Library, IsSolved) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "fclib"))
    if (entry.path().extension() == ".hdf5") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  ASSERT_EQ(paths.size(), 43u);
  const SolverOptions options{.tolerance = GetParam()};
  for (const std::filesystem::path& path : paths) {
    const FclibFile file = read_fclib(path);
    const FrictionSolution s =
        std::visit([&](const auto& problem) { return solve(problem, {}, options); }, file.problem);
    EXPECT_EQ(s.report.status, SolveStatus::converged) << path.stem();
    // What is written here and in the solver rounds differently: about 1e-13 where impulses are large.
    const double allowed = options.tolerance + 2e-13;
    const Judged judged = judge(file, s.r);
    EXPECT_LT(scaled_error(judged, s.r, laws_of(file), true), allowed) << path.stem();
    EXPECT_LT(scaled_error(judged, s.r, laws_of(file), false), allowed) << path.stem();
  }
}
INSTANTIATE_TEST_SUITE_P(Tolerances, Library, ::testing::Values(1e-8, 1e-12));

}  // namespace
}  // namespace aussois
