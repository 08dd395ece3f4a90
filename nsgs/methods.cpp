// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/settings.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr double kMostExcused = 1e-6;  // by that: impulses may be as large as they like

using MethodFunction = Iterate (*)(Delassus&, const Iterate&, const SolverOptions&, SolveReport&);
struct MethodEntry {
  Method method;
  MethodFunction run;
  bool convex_cone = false;  // can solve that model too
};
constexpr std::array kMethods{
    MethodEntry{Method::automatic, automatic},
    MethodEntry{Method::nsgs, nsgs},
    MethodEntry{Method::coloured_nsgs, coloured_nsgs},
    MethodEntry{Method::sor_prox, sor_prox},
    MethodEntry{Method::jor_prox, jor_prox},
    MethodEntry{Method::coulomb_pgs, coulomb_pgs},
    MethodEntry{Method::proximal_newton, proximal_newton},
    MethodEntry{Method::admm, admm, true},
    MethodEntry{Method::projected_gradient, projected_gradient, true},
    MethodEntry{Method::interior_point, interior_point, true},
};

const MethodEntry& entry(Method method) {
  return *std::find_if(kMethods.begin(), kMethods.end(),
                       [&](const MethodEntry& e) { return e.method == method; });
}

constexpr Named<Method> kMethodNames[] = {{Method::automatic, "auto"},
                                          {Method::nsgs, "nsgs"},
                                          {Method::coloured_nsgs, "coloured_nsgs"},
                                          {Method::sor_prox, "sor_prox"},
                                          {Method::jor_prox, "jor_prox"},
                                          {Method::coulomb_pgs, "coulomb_pgs"},
                                          {Method::proximal_newton, "proximal_newton"},
                                          {Method::admm, "admm"},
                                          {Method::projected_gradient, "projected_gradient"},
                                          {Method::interior_point, "interior_point"}};
constexpr Named<SolveStatus> kStatuses[] = {{SolveStatus::converged, "converged"},
                                            {SolveStatus::at_rounding, "at_rounding"},
                                            {SolveStatus::stagnated, "stagnated"},
                                            {SolveStatus::max_iterations, "max_iterations"},
                                            {SolveStatus::not_finite, "not_finite"}};
constexpr Named<FrictionModel> kModels[] = {{FrictionModel::coulomb, "coulomb"},
                                            {FrictionModel::convex_cone, "convex_cone"}};
constexpr Named<LocalSolver> kLocalSolvers[] = {{LocalSolver::hybrid, "hybrid"},
                                                {LocalSolver::enumerative, "enumerative"},
                                                {LocalSolver::alart_curnier, "alart_curnier"},
                                                {LocalSolver::projection, "projection"}};
constexpr Named<ProxMetric> kMetrics[] = {
    {ProxMetric::blocks, "blocks"}, {ProxMetric::split, "split"}, {ProxMetric::spectral, "spectral"}};

}  // namespace

Iterate run_method(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  return entry(options.method).run(W, start, options, report);
}

bool JudgeSchedule::due(int iteration, double change, double tolerance) {
  if (iteration < next_ && change > tolerance) return false;
  next_ = iteration + 1 + iteration / 5;
  return true;
}

void BestSoFar::offer(Iterate other, int step) {
  if (other.residual < best_.residual) best_ = std::move(other);
  if (best_.residual <= halved_ / 2) halved_ = best_.residual, halved_at_ = step;
}

bool BestSoFar::ends(const Iterate& now, int step, double tolerance, SolveStatus& status) {
  offer(now, step);
  if (now.residual == kInf)
    status = SolveStatus::not_finite;
  else if (best_.residual <= tolerance)
    status = SolveStatus::converged;
  else if (stagnated(step))
    status = SolveStatus::stagnated;
  else
    return false;
  return true;
}

Iterate judged(Delassus& W, VecX r, Method by) {
  Iterate iterate{.r = std::move(r), .by = by};
  iterate.u = W.velocity(iterate.r);
  const double residual = natural_map(iterate.u, iterate.r, W.scaled.laws, W.scaled.model);
  iterate.residual = std::isfinite(residual) ? residual : kInf;
  return iterate;
}

bool is_at_rounding(const Delassus& W, const Iterate& iterate, double times) {
  if (!(iterate.residual <= kMostExcused)) return false;
  const VecX terms = W.matrix().cwiseAbs() * iterate.r.cwiseAbs() + W.scaled.q.cwiseAbs();
  return iterate.residual <= times * kCancellation * terms.norm();
}

const char* to_string(Method method) {
  return name_of(method, kMethodNames);
}
Method method(const std::string& name) {
  return value_named(name, "solver", kMethodNames);
}
const char* to_string(SolveStatus status) {
  return name_of(status, kStatuses);
}

void describe(SettingVisitor& visit, SolverOptions& o) {
  visit.begin("SolverOptions");
  visit.choice({.name = "method",
                .what = "solver; auto starts with nsgs and changes to Newton's method if that is cheaper",
                .flag = "--solver"},
               o.method, kMethodNames);
  visit.choice({.name = "model",
                .what = "friction model; convex_cone omits De Saxce's term, so slipping contacts lift off",
                .flag = "--model"},
               o.model, kModels);
  visit.number({.name = "tolerance",
                .what = "tolerance on the scaled residual",
                .unit = "-",
                .range = open_range(0, 1),
                .flag = "--tolerance"},
               o.tolerance);
  visit.count({.name = "max_iterations",
               .what = "maximum number of sweeps or steps of the solver",
               .unit = "",
               .range = range_from(1),
               .flag = "--max-iterations"},
              o.max_iterations);
  visit.number({.name = "relaxation",
                .what = "relaxation factor",
                .unit = "-",
                .range = open_range(0, 2),
                .flag = "--relaxation",
                .only_for = "auto, nsgs, coloured_nsgs, sor_prox, jor_prox, admm"},
               o.relaxation);
  visit.choice({.name = "local",
                .what = "method that solves a single contact",
                .flag = "--local",
                .only_for = "auto, nsgs, coloured_nsgs"},
               o.local, kLocalSolvers);
  visit.choice(
      {.name = "prox", .what = "step-size matrix R", .flag = "--prox", .only_for = "sor_prox, jor_prox"},
      o.prox, kMetrics);
  visit.count({.name = "anderson",
               .what = "number of iterates that Anderson acceleration combines; 0: no acceleration",
               .unit = "",
               .range = {0, 20},
               .flag = "--anderson",
               .only_for = "nsgs, coloured_nsgs, sor_prox, jor_prox, coulomb_pgs, admm"},
              o.anderson);
  visit.toggle({.name = "estimate_error",
                .what = "estimate the error of the velocities relative to |q| by solving further "
                        "(doc/theory/automatic.md)",
                .flag = "--estimate-error",
                .changes_nothing = true,
                .only_for = "model: coulomb"},
               o.estimate_error);
}

void validate(const SolverOptions& options) {
  check_options(options);
  require_field(options.model == FrictionModel::coulomb || entry(options.method).convex_cone,
                "SolverOptions::model", "convex_cone",
                "be coulomb, or the method admm, projected_gradient or interior_point");
}

}  // namespace aussois
