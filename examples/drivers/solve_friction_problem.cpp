// SPDX-License-Identifier: Apache-2.0
// Solves saved one-step problems: those of FCLIB or Siconos, or a step saved by --dump-problem.
//
// Theory   doc/theory/nsgs.md (NSGS-1), (NSGS-2), (NSGS-8) to (NSGS-11); the files: doc/fclib_file.md
// Run      solve_friction_problem data/problems --json out/problems.json
//          solve_friction_problem data/problems --start guess --json out/problems.json
// Expect   every problem converged to 1e-8 on the scaled residual; exit code 0
#include <algorithm>
#include <cstdio>

#include "examples/common/progress.hpp"
#include "examples/common/setting_flags.hpp"
#include "examples/studies/friction/problem_run.hpp"
#include "geometry/number_text.hpp"
#include "geometry/parallel.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> files{};
  RunOptions run{};
  SaidSettings said{};
  int threads = 1;
  std::filesystem::path json{};
  bool quiet = false;
};

RunOptions run_of(const Arguments& a) {
  RunOptions out = a.run;
  take(a.said, out);
  out.solver.for_all = [threads = a.threads](int n, const std::function<void(int)>& f) {
    parallel_for(n, threads, f);
  };
  return out;
}

ExitCode solve_all(const Arguments& a, const RunOptions& options) {
  validate(options);
  const std::vector<std::filesystem::path> files = problem_files(a.files);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());
  if (!options.save.empty()) std::filesystem::create_directories(options.save);

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
  std::printf("%s: %ld of %s solved to %g in %.3g s of CPU time%s\n", to_string(options.solver.method),
              long(solved), counted_noun(std::int64_t(files.size()), "problem").c_str(),
              options.solver.tolerance, cpu_s, interrupted() ? ", interrupted" : "");
  if (interrupted()) return ExitCode::interrupted;
  if (unreadable > 0) return ExitCode::missing;
  return std::size_t(solved) == files.size() ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("solve_friction_problem",
          "Solves frictional contact problems saved as HDF5 files in FCLIB's layout. An unreadable file does "
          "not stop the run.");
  cli.group("scene");
  cli.files(a.files, "HDF5 files, or folders that contain them");
  add_flags(cli, a.run, a.said, {"--start"});
  cli.group("solver");
  add_flags(cli, a.run.solver, a.said);
  cli.option("--threads", a.threads, "number of threads for islands and colours; does not affect the results",
             "", kThreads);
  cli.group("output");
  cli.option("--json", a.json, "write a list with one object per problem to this JSON file");
  cli.option("--save", a.run.save, "write each problem, with the computed solution, to this folder");
  add_flags(cli, a.run, a.said, {"--repeat"});
  cli.flag("--quiet", a.quiet, "omit progress and the table");
  cli.example("solve_friction_problem box.hdf5", "one problem, its residuals and physical errors");
  cli.example("solve_friction_problem fclib/ --solver nsgs --tolerance 1e-4 --json nsgs.json",
              "all problems of a folder");
  return run_driver(cli, argc, argv, [&] {
    const RunOptions options = run_of(a);
    refuse_unread_flags(cli, options.solver);
    return solve_all(a, options);
  });
}
