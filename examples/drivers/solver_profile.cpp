// SPDX-License-Identifier: Apache-2.0
// How fast is each solver, and on how many problems? Draws performance profiles of several solvers on a
// folder of problems. It can be interrupted at any time: the next call with the same -o continues.
//
// Theory   doc/theory/nsgs.md (NSGS-9), [Dolan2002]; the files: doc/fclib_file.md
// Run      solver_profile data/problems --solvers auto,nsgs --tolerances 1e-4,1e-8
// Expect   auto solves all problems
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "examples/common/driver.hpp"
#include "examples/common/gnuplot.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/setting_flags.hpp"
#include "examples/studies/friction/limited_run.hpp"
#include "examples/studies/friction/performance_profile.hpp"
#include "examples/studies/friction/profile_result.hpp"
#include "geometry/check.hpp"
#include "io/build_info.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> files{};
  std::string solvers = "auto,nsgs,proximal_newton", tolerances = "1e-4,1e-8,1e-12";
  RunOptions run{};  // method and tolerance of its solver are those of the lists
  SaidSettings said{};
  double time_limit = 60;
  std::filesystem::path out = "out";
  bool quiet = false;
};

struct Problem {
  std::filesystem::path file{};
  std::uint64_t digest = 0;
  int contacts = 0;
};

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t comma = std::min(list.find(',', at), list.size());
    if (comma > at) words.push_back(list.substr(at, comma - at));
    at = comma + 1;
  }
  return words;
}

std::vector<double> tolerances_of(const std::string& list) {
  std::vector<double> tolerances;
  for (const std::string& word : words_of(list)) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    require(error == std::errc() && end == word.data() + word.size() && value > 0 && value < 1,
            "--tolerances " + word + " must be comma-separated numbers in (0, 1)");
    tolerances.push_back(value);
  }
  require(!tolerances.empty(), "--tolerances must name at least one tolerance");
  return tolerances;
}

/// "1e-08", "2.5e-09".
std::string short_text(double tolerance) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, tolerance, std::chars_format::scientific).ptr};
}

/// Those that can be read; the others are reported and left out.
std::vector<Problem> readable(const std::vector<std::filesystem::path>& files) {
  std::vector<Problem> problems;
  for (const std::filesystem::path& file : files) {
    try {
      const int contacts = int(laws_of(read_fclib(file)).size());
      problems.push_back({.file = file, .digest = file_digest(file), .contacts = contacts});
    } catch (const std::exception& error) {
      std::fprintf(stderr, "warning: left out: %s\n", error.what());
    }
  }
  return problems;
}

ProfileKey key_of(const Arguments& a, const Problem& problem, const std::string& solver, double tolerance) {
  ProfileKey key{.digest = problem.digest, .options = a.run, .program = program_digest()};
  key.options.solver.method = method(solver);
  key.options.solver.tolerance = tolerance;
  return key;
}

/// By its file.
using Results = std::map<std::filesystem::path, ProfileResult>;

std::filesystem::path results_folder(const Arguments& a) {
  return a.out / "results";
}

/// The results of all solvers on all problems; what the folder does not know is solved. Nothing: interrupted.
std::optional<Results> results_of(const Arguments& a, const std::vector<Problem>& problems,
                                  const std::vector<std::string>& solvers,
                                  const std::vector<double>& tolerances) {
  const std::filesystem::path folder = results_folder(a);
  std::filesystem::create_directories(folder);
  const double total = double(problems.size() * solvers.size() * tolerances.size());
  double done = 0;
  int known = 0;
  Results results;
  Progress progress("solver_profile", total, Progress::style_of_stderr(a.quiet));
  for (const Problem& problem : problems)
    for (const std::string& solver : solvers)
      for (const double tolerance : tolerances) {
        const ProfileKey key = key_of(a, problem, solver, tolerance);
        std::optional<ProfileResult> result = read_profile_result(folder, key, a.time_limit);
        if (result) {
          ++known;
        } else {
          progress.at(done, solver + " on " + problem.file.stem().string());
          result = run_limited(problem.file, key.options, a.time_limit);
          if (interrupted()) return {};
          result->contacts = problem.contacts;  // also of what was ended
          write_profile_result(folder, key, *result);
        }
        results[profile_result_file(folder, key)] = *result;
        ++done;
      }
  progress.at(total);
  if (known > 0) std::printf("%d of %.0f results were already in %s\n", known, total, folder.c_str());
  return results;
}

/// The seconds of each solver on each problem, infinity where it failed.
std::vector<std::vector<double>> costs(const Arguments& a, const Results& results,
                                       const std::vector<Problem>& problems,
                                       const std::vector<std::string>& solvers, double tolerance) {
  std::vector<std::vector<double>> cost;
  for (const std::string& solver : solvers) {
    cost.emplace_back();
    for (const Problem& problem : problems) {
      const ProfileResult& result =
          results.at(profile_result_file(results_folder(a), key_of(a, problem, solver, tolerance)));
      cost.back().push_back(result.solved && result.cpu_s <= a.time_limit ? std::max(result.cpu_s, 1e-9)
                                                                          : kInf);
    }
  }
  return cost;
}

std::string share_lines(const std::vector<std::string>& solvers, const std::vector<std::vector<double>>& cost,
                        const PerformanceProfile& profile) {
  std::string text;
  char line[160];
  std::snprintf(line, sizeof line, "%-20s %10s %10s %12s %12s\n", "solver", "solved", "of", "fastest of",
                "cpu s solved");
  text += line;
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    double seconds = 0;
    int solved = 0;
    for (const double t : cost[s])
      if (std::isfinite(t)) seconds += t, ++solved;
    std::snprintf(line, sizeof line, "%-20s %10d %10zu %11.0f%% %12.3g\n", solvers[s].c_str(), solved,
                  cost[s].size(), 100 * profile.share[s].front(), seconds);
    text += line;
  }
  return text;
}

ExitCode profile(const Arguments& a) {
  const std::vector<std::string> solvers = words_of(a.solvers);
  require(!solvers.empty(), "--solvers must name at least one solver");
  for (const std::string& solver : solvers) method(solver);  // throws if it is none
  const std::vector<double> tolerances = tolerances_of(a.tolerances);
  const std::vector<std::filesystem::path> files = problem_files(a.files);
  const std::vector<Problem> problems = readable(files);
  if (problems.empty()) throw std::runtime_error("none of the files can be read");
  const std::optional<Results> results = results_of(a, problems, solvers, tolerances);
  if (!results) return ExitCode::interrupted;

  // A profile per tolerance.
  bool pictures = true;
  std::size_t first_solved = 0;
  for (const double tolerance : tolerances) {
    const std::vector<std::vector<double>> cost = costs(a, *results, problems, solvers, tolerance);
    const PerformanceProfile curves = performance_profile(cost);
    char title[120];
    std::snprintf(title, sizeof title, "%zu problems to %g on the scaled residual, CPU time", problems.size(),
                  tolerance);
    pictures = write_profile(a.out, "profile_" + short_text(tolerance), solvers, curves, title) && pictures;
    std::printf("%s\n%s", title, share_lines(solvers, cost, curves).c_str());
    first_solved += std::size_t(
        std::count_if(cost.front().begin(), cost.front().end(), [](double t) { return std::isfinite(t); }));
  }
  if (!pictures) tell_no_picture();
  std::printf("solver_profile: %s solved %zu of %zu; profiles in %s\n", solvers.front().c_str(), first_solved,
              problems.size() * tolerances.size(), a.out.c_str());
  if (problems.size() < files.size()) return ExitCode::missing;
  return first_solved == problems.size() * tolerances.size() ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("solver_profile",
          "Solves problems with several solvers and draws the share of problems that each solves within a "
          "factor of the best time. Exit code 0 requires that the first solver solves all of them.");
  cli.group("scene");
  cli.files(a.files, "HDF5 files in FCLIB's layout, or folders that contain them");
  cli.group("solver");
  cli.option("--solvers", a.solvers, "comma-separated names of solvers (methods of nsgs/solve.hpp)");
  cli.option("--tolerances", a.tolerances,
             "comma-separated tolerances on the scaled residual; each gets its own picture");
  add_flags(cli, a.run, a.said, {"--max-iterations"});
  cli.option("--time-limit", a.time_limit,
             "CPU time per problem, including all repeats; a solver that needs more has failed", "s",
             {1e-3, 1e7});
  add_flags(cli, a.run, a.said, {"--repeat"});
  cli.group("output");
  cli.option("-o,--out", a.out,
             "folder for the profiles, created if missing; its folder results has a JSON file for each "
             "result, and those that this program has already saved there are reused");
  cli.flag("--quiet", a.quiet, "omit progress; still print warnings");
  cli.example("solver_profile fclib/ --solvers auto,nsgs --tolerances 1e-8", "open out/profile_1e-08.png");
  cli.example("solver_profile fclib/ --time-limit 600",
              "later, with a higher limit: solves only the problems that the lower one stopped");
  return run_driver(cli, argc, argv, [&] {
    take(a.said, a.run);
    return profile(a);
  });
}
