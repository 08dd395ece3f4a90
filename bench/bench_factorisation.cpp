// SPDX-License-Identifier: Apache-2.0
// Compares factorisations for the solver's linear systems: times one factorisation and one solve of W + s by
// each candidate, on the matrices of friction problems, beside the one that the solver chooses.
//
// Theory   doc/theory/proximal_newton.md, doc/theory/admm.md (ADMM-2)
// Run      bench_factorisation data/problems
// Expect   the choice within 1.5 of the best candidate, geometric mean, with PASS
#include <cmath>
#include <cstdio>
#include <optional>

#include <Eigen/KLUSupport>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#ifdef AUSSOIS_BENCH_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include "bench/call_time.hpp"
#include "bench/verdict.hpp"
#include "examples/common/driver.hpp"
#include "examples/studies/friction/problem_run.hpp"
#include "geometry/check.hpp"
#include "io/fclib_file.hpp"
#include "nsgs/factorised.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> files{};
  double shift = 0.1, budget = 0.02;
  int smallest = 60, largest_dense = 2000;
};

struct Candidate {
  const char* name = "";
  /// |A x - b| / |b|; nothing if the candidate does not apply or fails.
  std::optional<double> (*solve)(const SparseMatrix& A, const VecX& b) = nullptr;
};

std::optional<double> wrong(const SparseMatrix& A, const VecX& x, const VecX& b) {
  const double e = (A * x - b).norm() / b.norm();
  return e < 1e-6 ? std::optional<double>(e) : std::nullopt;
}

bool is_symmetric(const SparseMatrix& A) {
  return (A - SparseMatrix(A.transpose())).norm() <= 1e-14 * A.norm();
}

std::optional<double> dense_lu(const SparseMatrix& A, const VecX& b) {
  if (A.rows() > Arguments{}.largest_dense) return std::nullopt;
  return wrong(A, MatX(A).partialPivLu().solve(b), b);
}

template <class Factor, bool Symmetric>
std::optional<double> sparse(const SparseMatrix& A, const VecX& b) {
  if (Symmetric && !is_symmetric(A)) return std::nullopt;
  const Factor factor(A);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return wrong(A, factor.solve(b), b);
}

std::optional<double> chosen(const SparseMatrix& A, const VecX& b) {
  const LinearSolve solve = factorised(A);
  return solve ? wrong(A, solve(b), b) : std::nullopt;
}

const std::vector<Candidate>& candidates() {
  static const std::vector<Candidate> all = {
      {"dense LU", dense_lu},
      {"LDL^T", sparse<Eigen::SimplicialLDLT<SparseMatrix>, true>},
      {"KLU", sparse<Eigen::KLU<SparseMatrix>, false>},
#ifdef AUSSOIS_BENCH_CHOLMOD
      {"CHOLMOD", sparse<Eigen::CholmodSupernodalLLT<SparseMatrix>, true>},
#endif
      {"chosen", chosen},
  };
  return all;
}

/// W of the problem with unit blocks on the diagonal, as the solver sees it, and a shift.
SparseMatrix matrix_of(const std::filesystem::path& file, double shift) {
  const FclibFile read = read_fclib(file);
  const auto* bodies = std::get_if<FrictionProblem>(&read.problem);
  SparseMatrix W = bodies ? condense(*bodies).W : std::get<LocalProblem>(read.problem).W;
  const VecX s = VecX(W.diagonal()).cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  W = s.asDiagonal() * W * s.asDiagonal();
  for (Eigen::Index i = 0; i < W.rows(); ++i) W.coeffRef(i, i) += shift;
  W.makeCompressed();
  return W;
}

double call_time(const std::function<void()>& f, double budget) {
  const double begin = cpu_seconds();
  f();
  return fastest_call(
      cpu_seconds() - begin, budget, [](int n) { return std::vector<char>(std::size_t(n)); },
      [&](char) { f(); });
}

ExitCode bench(const Arguments& a) {
  std::printf("%-40s %6s %8s", "problem", "rows", "entries");
  for (const Candidate& c : candidates()) std::printf(" %10s", c.name);
  std::printf("   ms of a factorisation and a solve\n");
  double log_ratio = 0, worst = 0;
  std::string worst_problem;
  int count = 0;
  for (const std::filesystem::path& file : problem_files(a.files)) {
    if (interrupted()) return ExitCode::interrupted;
    const SparseMatrix W = matrix_of(file, a.shift);
    if (W.rows() < a.smallest) continue;
    const VecX b = VecX::LinSpaced(W.rows(), -1, 1);
    std::printf("%-40s %6ld %8ld", file.stem().c_str(), long(W.rows()), long(W.nonZeros()));
    double best = kInf, ours = kInf;
    for (const Candidate& c : candidates()) {
      if (!c.solve(W, b)) {
        std::printf(" %10s", "-");
        continue;
      }
      const double ms = 1e3 * call_time([&] { c.solve(W, b); }, a.budget);
      std::printf(" %10.3f", ms);
      (c.solve == chosen ? ours : best) = std::min(c.solve == chosen ? ours : best, ms);
    }
    std::printf("\n");
    const double ratio = ours / best;
    log_ratio += std::log(ratio);
    if (ratio > worst) worst = ratio, worst_problem = file.stem().string();
    ++count;
  }
  require(count > 0, "no problem has as many rows as --smallest");
  return print_verdicts({{.key = "worst_ratio",
                          .what = "time of the choice over the best candidate's, longest",
                          .where = worst_problem,
                          .value = worst,
                          .wanted = 3},
                         {.key = "geometric_mean_ratio",
                          .what = "time of the choice over the best candidate's, geometric mean",
                          .value = std::exp(log_ratio / count),
                          .wanted = 1.5}})
             ? ExitCode::ok
             : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_factorisation",
          "Times one factorisation and one solve of W + shift by each candidate on the matrices of friction "
          "problems, beside the one that the solver chooses.");
  cli.group("scene");
  cli.files(a.files, "HDF5 files, or folders of them");
  cli.option("--smallest", a.smallest, "rows; smaller problems are left out", "", {1, 1e6});
  cli.group("measurement");
  cli.option("--shift", a.shift, "added to the diagonal of W, whose entries are 1", "-", {1e-12, 1e3});
  cli.option("--budget", a.budget, "CPU time for repeats of each measurement", "s", {0, 1e3});
  cli.example("bench_factorisation DIR", "a table, and how far the choice is from the best");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
