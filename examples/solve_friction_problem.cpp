// SPDX-License-Identifier: Apache-2.0
// Solve one-step problems that somebody has saved: FCLIB's, Siconos', or a step of ours (--dump-problem).
//
// Theory   doc/theory/nsgs.md (NSGS-1), (NSGS-2), (NSGS-8) to (NSGS-11); the files: doc/fclib_file.md
// Run      solve_friction_problem data/problems --json out/problems.json
//          solve_friction_problem data/problems --start guess --json out/problems.json
// Expect   every problem converged to 1e-8 on the scaled residual; the exit code says whether
#include <algorithm>
#include <cstdio>

#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "examples/friction/problem_run.hpp"
#include "geometry/number_text.hpp"
#include "geometry/parallel.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> files{};
  std::string solver = "auto", local = "hybrid", model = "coulomb", prox = "blocks", start = "zero";
  double tolerance = 1e-8, relaxation = 1;
  int max_iterations = SolverOptions{}.max_iterations, anderson = 0, threads = 1, repeat = 1;
  std::filesystem::path json{}, save{};
  bool quiet = false, estimate_error = false;
};

LocalSolver local_named(const std::string& name) {
  return name == "enumerative"     ? LocalSolver::enumerative
         : name == "alart_curnier" ? LocalSolver::alart_curnier
         : name == "projection"    ? LocalSolver::projection
                                   : LocalSolver::hybrid;
}

ProxMetric metric_named(const std::string& name) {
  return name == "split" ? ProxMetric::split : name == "spectral" ? ProxMetric::spectral : ProxMetric::blocks;
}

SolverOptions solver_of(const Arguments& a) {
  return {.method = method(a.solver),
          .model = a.model == "convex_cone" ? FrictionModel::convex_cone : FrictionModel::coulomb,
          .tolerance = a.tolerance,
          .max_iterations = a.max_iterations,
          .relaxation = a.relaxation,
          .local = local_named(a.local),
          .prox = metric_named(a.prox),
          .anderson = a.anderson,
          .estimate_error = a.estimate_error,
          .for_all = [threads = a.threads](int n, const std::function<void(int)>& f) {
            parallel_for(n, threads, f);
          }};
}

ExitCode solve_all(const Arguments& a) {
  const RunOptions options{
      .solver = solver_of(a), .start = start_named(a.start), .repeat = a.repeat, .save = a.save};
  validate(options.solver);
  const std::vector<std::filesystem::path> files = problem_files(a.files);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
  if (!a.save.empty()) std::filesystem::create_directories(a.save);

  // 1. Solve, one problem after the other; a signal ends after the one at hand.
  std::vector<ProblemRun> runs;
  {
    Progress progress("solve_friction_problem", double(files.size()), Progress::style_of_stderr(a.quiet));
    for (const std::filesystem::path& file : files) {
      progress.at(double(runs.size()), file.stem().string());
      runs.push_back(run_problem(file, options));
      if (interrupted()) break;
    }
    if (!interrupted()) progress.at(double(files.size()));
  }

  // 2. Tell.
  if (!a.quiet) std::printf("%s", table_head(files).c_str());
  double cpu_s = 0;
  for (const ProblemRun& run : runs) {
    if (!a.quiet) std::printf("%s", table_row(run, files).c_str());
    cpu_s += run.cpu_s;
  }
  if (!a.json.empty()) write_json(a.json, runs);
  const auto solved = std::count_if(runs.begin(), runs.end(), [](const ProblemRun&r) { return r.solved; }),
             unreadable = std::count_if(runs.begin(), runs.end(),
                                        [](const ProblemRun&r) { return r.status == "unreadable"; });
  std::printf("%s: %ld of %s solved to %g in %.3g s of CPU time%s\n", a.solver.c_str(), long(solved),
              counted(std::int64_t(files.size()), "problem").c_str(), a.tolerance, cpu_s,
              interrupted() ? ", interrupted" : "");
  if (interrupted()) return ExitCode::interrupted;
  if (unreadable > 0) return ExitCode::missing;
  return std::size_t(solved) == files.size() ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "solve_friction_problem",
      "Solves frictional contact problems saved as HDF5 in FCLIB's layout. A file that cannot be read does "
      "not stop the others.");
  cli.group("scene");
  cli.files(a.files, "HDF5 files, or folders of them");
  cli.choice("--start", a.start, "impulses to start from; zero where the file has no guess or solution",
             {"zero", "guess", "solution"});
  cli.group("solver");
  cli.option("--solver", a.solver, "auto chooses; any method of nsgs/solve.hpp by its name");
  cli.option("--tolerance", a.tolerance, "on the scaled residual", "-", {1e-16, 0.1});
  cli.option("--max-iterations", a.max_iterations, "sweeps or steps of the method", "", {1, 1e9});
  cli.choice("--local", a.local, "how nsgs solves one contact",
             {"hybrid", "enumerative", "alart_curnier", "projection"});
  cli.choice("--model", a.model, "convex_cone: without De Saxce's term, what slips lifts off",
             {"coulomb", "convex_cone"});
  cli.choice("--prox", a.prox, "R of sor_prox and jor_prox", {"blocks", "split", "spectral"});
  cli.option("--relaxation", a.relaxation, "of nsgs, sor_prox, jor_prox, admm, inside (0, 2)", "-",
             {1e-3, 1.999});
  cli.option("--anderson", a.anderson, "iterates that Anderson acceleration combines; 0: none", "", {0, 20});
  cli.flag(
      "--estimate-error", a.estimate_error,
      "how far velocities are from exact ones, of |q|: those of an answer that is solved on from it (SOL-4)");
  cli.option("--threads", a.threads, "for islands and colours; the results do not depend on it", "",
             {1, 256});
  cli.group("output");
  cli.option("--json", a.json, "write a list with an object per problem to this file");
  cli.option("--save", a.save, "write each problem, with its answer as solution, into this folder");
  cli.option("--repeat", a.repeat, "solve each problem so often; the smallest time counts", "", {1, 1e9});
  cli.flag("--quiet", a.quiet, "no progress, no table");
  cli.example("solve_friction_problem box.hdf5", "one problem, its residuals and physical errors");
  cli.example("solve_friction_problem fclib/ --solver nsgs --tolerance 1e-4 --json nsgs.json",
              "all problems of a folder");
  return run_driver(cli, argc, argv, [&] { return solve_all(a); });
}
