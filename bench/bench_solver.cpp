// SPDX-License-Identifier: Apache-2.0
// Compares our automatic solver with Siconos on the same problems, in one run and with one judge: with its
// best solver, chosen for each problem after all have run, and with its default. Read the ratios, not the
// times.
//
// Theory   doc/theory/nsgs.md (NSGS-9); the files: doc/fclib_file.md
// Run      bench_solver data/problems
//          bench_solver data/problems --tolerance 1e-12 --json out/bench_solver.json
// Expect   a line per verdict, with PASS; the last one is the geometric mean of the ratios to the best solver
// of Siconos
#include <cstdio>

#include "bench/solver_report.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "examples/studies/friction/problem_run.hpp"
#include "geometry/check.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> files{};
  std::filesystem::path json{};
  SolverCostOptions cost{};
  CommonOptions common{};
};

ExitCode bench(const Arguments& a) {
  require(a.common.threads == 1, "--threads must be 1: one thread is timed");
  require_field(a.cost.tolerance <= a.cost.coarse, "--coarse", a.cost.coarse, "be at least --tolerance");
  const std::vector<std::filesystem::path> files = problem_files(a.files);
  make_folders(a.common);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
#ifndef AUSSOIS_BENCH_SICONOS
  std::fprintf(stderr, "no peer: Siconos Numerics was not there when this was configured\n");
#endif

  // 1. Measure.
  std::vector<ProblemCost> costs;
  Progress progress("bench_solver", double(files.size()), Progress::style_of_stderr(a.common.quiet));
  for (const std::filesystem::path& file : files) {
    costs.push_back(measure_problem(file, a.cost, [&](const std::string& what) {
      progress.at(double(costs.size()), what);
      return !interrupted();
    }));
    if (interrupted()) return ExitCode::interrupted;
  }

  // 2. Report.
  std::printf("\n%s", solver_table_head(a.cost).c_str());
  for (const ProblemCost& cost : costs) std::printf("%s", line_of(cost).c_str());
  if (!a.json.empty()) write_solver_json(a.json, costs, a.cost);
  if (!write_solver_plot(a.common.out, costs))
    std::fprintf(stderr, "no picture: gnuplot is not there, or fails on %s\n",
                 (a.common.out / "bench_solver.gp").c_str());
  std::printf("\n%s", siconos_line(costs, a.cost).c_str());
  return print_verdicts(solver_verdicts(costs)) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "bench_solver",
      "Times our automatic solver against those of Siconos on frictional contact problems: CPU time of one "
      "thread from r = 0, the fastest of several calls, judged by our scaled residual. Siconos gets W in "
      "rows of blocks and the tolerance of its own that meets ours. It is left out where it is not "
      "installed. Global problems are condensed before either clock starts. The last column is our time from "
      "the bodies, over that of condensing and Siconos together.");
  cli.group("scene");
  cli.files(a.files, "HDF5 files, or folders of them");
  cli.group("measurement");
  cli.option("--tolerance", a.cost.tolerance, "on the scaled residual, against the best solver of Siconos",
             "-", {1e-15, 0.1});
  cli.option("--coarse", a.cost.coarse, "the same against the default solver of Siconos", "-", {1e-15, 0.1});
  cli.option("--time-limit", a.cost.time_limit, "of a run of Siconos", "s", {0.1, 1e5});
  cli.option("--budget", a.cost.budget, "CPU time for repeats of each measurement", "s", {0, 1e3});
  cli.option("--json", a.json, "file for all numbers");
  cli.common(a.common);
  cli.example("bench_solver DIR -o out", "all problems, with out/bench_solver.csv and a picture");
  cli.example("bench_solver DIR --json out/bench_solver.json", "times of every solver of Siconos");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
