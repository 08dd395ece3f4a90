// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/check.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr double kMostExcused = 1e-6;  // by that: impulses may be as large as they like

using MethodFunction = Iterate (*)(Delassus&, const Iterate&, const SolverOptions&, SolveReport&);
struct MethodEntry {
  Method method;
  const char* name;
  MethodFunction run;
  bool convex_cone = false;  // can solve that model too
};
constexpr std::array kMethods{
    MethodEntry{Method::automatic, "auto", automatic},
    MethodEntry{Method::nsgs, "nsgs", nsgs},
    MethodEntry{Method::coloured_nsgs, "coloured_nsgs", coloured_nsgs},
    MethodEntry{Method::sor_prox, "sor_prox", sor_prox},
    MethodEntry{Method::jor_prox, "jor_prox", jor_prox},
    MethodEntry{Method::coulomb_pgs, "coulomb_pgs", coulomb_pgs},
    MethodEntry{Method::proximal_newton, "proximal_newton", proximal_newton},
    MethodEntry{Method::admm, "admm", admm, true},
    MethodEntry{Method::projected_gradient, "projected_gradient", projected_gradient, true},
    MethodEntry{Method::interior_point, "interior_point", interior_point, true},
};

const MethodEntry& entry(Method method) {
  return *std::find_if(kMethods.begin(), kMethods.end(),
                       [&](const MethodEntry& e) { return e.method == method; });
}

}  // namespace

Iterate run(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
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
  return entry(method).name;
}

Method method(const std::string& name) {
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
    case SolveStatus::at_rounding:
      return "at_rounding";
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
  require_field(options.model == FrictionModel::coulomb || entry(options.method).convex_cone,
                "SolverOptions::model", "convex_cone",
                "be coulomb, or the method admm, projected_gradient or interior_point");
}

}  // namespace aussois
