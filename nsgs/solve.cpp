// SPDX-License-Identifier: Apache-2.0
#include "nsgs/solve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/check.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

using MethodFunction = Iterate (*)(Delassus&, const Iterate&, const SolverOptions&, SolveReport&);
struct MethodEntry {
  Method method;
  const char* name;
  MethodFunction run;
};
constexpr std::array kMethods{
    MethodEntry{Method::automatic, "auto", automatic},
    MethodEntry{Method::nsgs, "nsgs", nsgs},
    MethodEntry{Method::sor_prox, "sor_prox", sor_prox},
    MethodEntry{Method::jor_prox, "jor_prox", jor_prox},
    MethodEntry{Method::coulomb_pgs, "coulomb_pgs", coulomb_pgs},
    MethodEntry{Method::proximal_newton, "proximal_newton", proximal_newton},
};

const MethodEntry& entry(Method method) {
  return *std::find_if(kMethods.begin(), kMethods.end(),
                       [&](const MethodEntry& e) { return e.method == method; });
}

FrictionSolution solve(Delassus& W, const VecX& r0, const SolverOptions& options) {
  FrictionSolution out;
  const Scaling& scaled = W.scaled;
  const Eigen::Index rows = scaled.s.size();
  if (!scaled.finite || !r0.allFinite()) {
    out.r = VecX::Zero(rows);
    out.report = {.status = SolveStatus::not_finite, .residual = kInf};
    return out;
  }
  Iterate start = judged(W, scaled_start(scaled, {}), options.method);
  if (r0.size() > 0)
    if (Iterate warm = judged(W, scaled_start(scaled, r0), options.method); warm.residual < start.residual)
      start = std::move(warm);
  const Iterate best =
      start.residual <= options.tolerance ? start : entry(options.method).run(W, start, options, out.report);
  out.report.residual = best.residual;
  out.report.found_by = best.by;
  out.r = scaled.size * scaled.s.cwiseProduct(best.r);
  out.u = scaled.size * best.u.cwiseQuotient(scaled.s);
  return out;
}

void validate_start(const VecX& r0, Eigen::Index rows) {
  const std::string bound = "be 0 or " + std::to_string(rows) + ", the rows of laws";
  require_field(r0.size() == 0 || r0.size() == rows, "r0.size()", r0.size(), bound.c_str());
}

FrictionSolution nothing_finite(const FrictionProblem& problem) {
  FrictionSolution solution{.v = VecX::Zero(problem.f.size()),
                            .u = problem.w,
                            .r = VecX::Zero(problem.w.size()),
                            .lambda = VecX::Zero(problem.b.size())};
  solution.report = {.status = SolveStatus::not_finite, .residual = kInf};
  return solution;
}

}  // namespace

bool JudgeSchedule::due(int iteration, double change, double tolerance) {
  if (iteration < next_ && change > tolerance) return false;
  next_ = iteration + 1 + iteration / 5;
  return true;
}

Iterate judged(Delassus& W, VecX r, Method by) {
  Iterate iterate{.r = std::move(r), .by = by};
  iterate.u = W.velocity(iterate.r);
  const double residual = natural_map(iterate.u, iterate.r, W.scaled.laws);
  iterate.residual = std::isfinite(residual) ? residual : kInf;
  return iterate;
}

const char* to_string(Method method) {
  return entry(method).name;
}

Method method_named(const std::string& name) {
  std::string names;
  for (const MethodEntry& e : kMethods) {
    if (name == e.name) return e.method;
    names += (names.empty() ? "" : ", ") + std::string(e.name);
  }
  throw std::invalid_argument("solver = " + name + " must be one of " + names);
}

const char* to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::converged:
      return "converged";
    case SolveStatus::stagnated:
      return "stagnated";
    case SolveStatus::max_iterations:
      return "max_iterations";
    case SolveStatus::not_finite:
      return "not_finite";
  }
  return "unknown";
}

void validate(const SolverOptions& options) {
  require_field(options.tolerance > 0 && options.tolerance < 1, "SolverOptions::tolerance", options.tolerance,
                "lie in (0, 1)");
  require_field(options.max_iterations >= 1, "SolverOptions::max_iterations", options.max_iterations,
                "be >= 1");
  require_field(options.relaxation > 0 && options.relaxation < 2, "SolverOptions::relaxation",
                options.relaxation, "lie in (0, 2)");
  require_field(options.anderson >= 0 && options.anderson <= 20, "SolverOptions::anderson", options.anderson,
                "lie in [0, 20]");
}

FrictionSolution solve(const LocalProblem& problem, const VecX& r0, const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.q.size());
  const std::unique_ptr<Delassus> W = make_delassus(problem);
  FrictionSolution solution = solve(*W, r0, options);
  if (solution.u.size() == 0) solution.u = problem.q;
  return solution;
}

FrictionSolution solve(const FrictionProblem& problem, const VecX& r0, const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.w.size());
  const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
  if (!inverse) return nothing_finite(problem);
  const bool few_contacts = problem.f.size() > 2 * problem.w.size();
  const bool condensed = inverse->mass.factor || inverse->joints || problem.R.size() > 0 || few_contacts;
  const std::unique_ptr<Delassus> W =
      condensed ? make_delassus(condense(problem, *inverse)) : make_delassus(problem, inverse->mass);
  FrictionSolution solution = solve(*W, r0, options);
  JointedMotion moved = motion(problem, *inverse, solution.r);
  solution.v = std::move(moved.v);
  solution.lambda = std::move(moved.lambda);
  if (solution.u.size() == 0) solution.u = problem.w;
  return solution;
}

}  // namespace aussois
