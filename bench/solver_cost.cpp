// SPDX-License-Identifier: Apache-2.0
#include "bench/solver_cost.hpp"

#include <algorithm>

#include "bench/call_time.hpp"
#include "io/fclib_file.hpp"
#include "nsgs/residual.hpp"

namespace aussois {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kShortestLimit = 0.1;  // [s]; the clock that ends a run ticks every few ms

template <class Call>
double fastest_of(double about, double budget, const Call& call) {
  return fastest_call(
      about, budget, [](int n) { return std::vector<char>(std::size_t(n)); }, [&](char) { call(); });
}

template <class Problem>
OurRun run_ours(const Problem& problem, const LocalProblem& judged, double tolerance, double budget) {
  const SolverOptions options{.tolerance = tolerance};
  const double begin = cpu_seconds();
  const FrictionSolution solution = solve(problem, {}, options);
  const double took = cpu_seconds() - begin;
  return {.report = solution.report,
          .solved = scaled_residual(judged, solution.r) <= tolerance,
          .cpu_s = fastest_of(took, budget, [&] { solve(problem, {}, options); })};
}

void run_peer(const LocalProblem& problem, const SolverCostOptions& options,
              const std::function<bool(const std::string&)>& step, ProblemCost& cost) {
#ifdef AUSSOIS_BENCH_SICONOS
  const std::vector<std::string> solvers = siconos_solvers(problem);
  if (!solvers.empty())
    cost.nsgs_coarse.push_back({solvers.front(), run_siconos(problem, solvers.front(), options.coarse,
                                                             options.time_limit, options.budget)});
  for (const std::string& solver : solvers) {
    if (!step(cost.name + " " + solver)) return;
    const NamedRun* best = best_siconos(cost);  // how much slower the others are does not matter
    const double limit =
        best ? std::clamp(2 * best->run.cpu_s, kShortestLimit, std::max(options.time_limit, kShortestLimit))
             : options.time_limit;
    cost.siconos.push_back({solver, run_siconos(problem, solver, options.tolerance, limit, options.budget)});
  }
#else
  (void)problem, (void)options, (void)step, (void)cost;
#endif
}

void measure(const LocalProblem& problem, const SolverCostOptions& options,
             const std::function<bool(const std::string&)>& step, ProblemCost& cost) {
  cost.contacts = problem.contact_count();
  cost.rows = int(problem.q.size());
  if (!step(cost.name)) return;
  cost.ours = run_ours(problem, problem, options.tolerance, options.budget);
  cost.ours_coarse = run_ours(problem, problem, options.coarse, options.budget);
  run_peer(problem, options, step, cost);
}

}  // namespace

const NamedRun* best_siconos(const ProblemCost& cost) {
  const NamedRun* best = nullptr;
  for (const NamedRun& named : cost.siconos)
    if (named.run.solved && (!best || named.run.cpu_s < best->run.cpu_s)) best = &named;
  return best;
}

double ratio_to_best(const ProblemCost& cost) {
  const NamedRun* best = best_siconos(cost);
  return best && cost.ours.solved ? cost.ours.cpu_s / best->run.cpu_s : kNone;
}

double ratio_to_nsgs(const ProblemCost& cost) {
  const bool both =
      !cost.nsgs_coarse.empty() && cost.nsgs_coarse.front().run.solved && cost.ours_coarse.solved;
  return both ? cost.ours_coarse.cpu_s / cost.nsgs_coarse.front().run.cpu_s : kNone;
}

double ratio_from_bodies(const ProblemCost& cost) {
  const NamedRun* best = best_siconos(cost);
  return best && cost.ours_global.solved ? cost.ours_global.cpu_s / (cost.condense_s + best->run.cpu_s)
                                         : kNone;
}

ProblemCost measure_problem(const std::filesystem::path& file, const SolverCostOptions& options,
                            const std::function<bool(const std::string&)>& step) {
  const FclibFile read = read_fclib(file);
  ProblemCost cost{.name = file.stem().string(), .form = "local"};
  if (const auto* local = std::get_if<LocalProblem>(&read.problem)) {
    measure(*local, options, step, cost);
    return cost;
  }
  const FrictionProblem& bodies = std::get<FrictionProblem>(read.problem);
  cost.form = "global";
  const double begin = cpu_seconds();
  const LocalProblem local = condense(bodies);
  const double took = cpu_seconds() - begin;
  cost.condense_s = fastest_of(took, options.budget, [&] { condense(bodies); });
  cost.ours_global = run_ours(bodies, local, options.tolerance, options.budget);
  measure(local, options, step, cost);
  return cost;
}

}  // namespace aussois
