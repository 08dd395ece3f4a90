// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/problem_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include <nlohmann/json.hpp>

#include "geometry/check.hpp"
#include "geometry/named.hpp"
#include "geometry/settings.hpp"
#include "io/atomic_file.hpp"

namespace aussois {
namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

VecX start_of(const FclibFile& file, Start& start) {
  if (start == Start::guess && !file.guesses.empty() && file.guesses.front().r.size() > 0)
    return file.guesses.front().r;
  if (start == Start::solution && file.solution && file.solution->r.size() > 0) return file.solution->r;
  start = Start::zero;
  return {};
}

void describe(const LocalProblem& problem, ProblemRun& run) {
  run.form = "local";
  run.contacts = problem.contact_count();
  run.rows = int(problem.q.size());
}
void describe(const FrictionProblem& problem, ProblemRun& run) {
  run.form = "global";
  run.contacts = problem.contact_count();
  run.rows = int(problem.w.size());
  run.bodies = int(problem.f.size());
  run.joints = int(problem.b.size());
}

const LocalProblem& condensed(const LocalProblem& problem) {
  return problem;
}
LocalProblem condensed(const FrictionProblem& problem) {
  return condense(problem);
}
double joint_velocity(const LocalProblem&, const FrictionSolution&) {
  return 0;
}
double joint_velocity(const FrictionProblem& problem, const FrictionSolution& solution) {
  if (problem.b.size() == 0) return 0;
  return VecX(problem.G.transpose() * solution.v + problem.b).cwiseAbs().maxCoeff();
}

FrictionSolution solved(const LocalProblem& problem, const VecX& r0, const SolverOptions& options) {
  return solve(problem, r0, options);
}
// As a step does that knows its free motion, so that what it dumped has the same bits.
FrictionSolution solved(const FrictionProblem& problem, const VecX& r0, const SolverOptions& options) {
  const std::optional<MassInverse> inverse = problem.G.cols() > 0 ? std::nullopt : invert_mass(problem.M);
  return inverse ? solve(problem, {*inverse, *inverse * problem.f}, r0, options)
                 : solve(problem, r0, options);
}

template <class Problem>
FclibValues run_on(const Problem& problem, const VecX& r0, const RunOptions& options, ProblemRun& run) {
  FrictionSolution solution;
  for (int i = 0; i < options.repeat; ++i) {
    const double begin = cpu_seconds();
    solution = solved(problem, r0, options.solver);
    const double took = cpu_seconds() - begin;
    run.cpu_s = i == 0 ? took : std::min(run.cpu_s, took);
  }
  run.report = solution.report;
  run.status = to_string(solution.report.status);
  if (solution.report.status == SolveStatus::not_finite) return {};
  const LocalProblem& judged = condensed(problem);  // u from r alone: the solver's own u is not asked
  run.natural_map_residual = natural_map_residual(judged, solution.r);
  run.scaled_residual = scaled_residual(judged, solution.r, options.solver.model);
  run.physical = physical_residual(VecX(judged.W * solution.r + judged.q), solution.r, judged.laws);
  run.worst_joint_velocity = joint_velocity(problem, solution);
  run.solved = is_solved(solution.report.status) && run.scaled_residual <= options.solver.tolerance;
  return {.r = solution.r, .u = solution.u, .v = solution.v, .l = solution.lambda};
}

int name_width(const std::vector<std::filesystem::path>& files) {
  std::size_t width = 7;
  for (const std::filesystem::path& file : files) width = std::max(width, file.stem().string().size());
  return int(std::min<std::size_t>(width, 60));
}

using Json = nlohmann::ordered_json;
Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json json_of(const ProblemRun& run) {
  Json out = {{"problem", run.problem}, {"status", run.status}, {"solved", run.solved}};
  if (!run.reason.empty()) out["reason"] = run.reason;
  if (run.form.empty()) return out;
  out["form"] = run.form;
  out["contacts"] = run.contacts;
  out["rows"] = run.rows;
  if (run.form == "global") {
    out["bodies_dof"] = run.bodies;
    out["joint_rows"] = run.joints;
  }
  out["solver"] = run.solver;
  out["start"] = to_string(run.start);
  out["found_by"] = to_string(run.report.found_by);
  out["iterations"] = run.report.iterations;
  out["newton_iterations"] = run.report.newton_iterations;
  out["local_failures"] = run.report.local_failures;
  out["local_fail_safes"] = run.report.local_fail_safes;
  out["natural_map_residual"] = number(run.natural_map_residual);
  out["scaled_residual"] = number(run.scaled_residual);
  out["coulomb_residual"] = number(run.report.coulomb_residual);
  out["worst_island_residual"] = number(run.report.worst_island);
  if (run.report.error >= 0) out["error_estimate"] = number(run.report.error);
  out["worst_normal_velocity"] = number(run.physical.worst_normal_approach);
  out["worst_cone_violation"] = number(run.physical.worst_cone_violation);
  out["worst_complementarity"] = number(run.physical.worst_complementarity);
  out["worst_misalignment"] = number(run.physical.worst_misalignment);
  out["worst_bilateral_velocity"] = number(run.physical.worst_bilateral);
  out["worst_joint_velocity"] = number(run.worst_joint_velocity);
  out["cpu_s"] = number(run.cpu_s);
  return out;
}

}  // namespace

constexpr Named<Start> kStarts[] = {
    {Start::zero, "zero"}, {Start::guess, "guess"}, {Start::solution, "solution"}};

const char* to_string(Start start) {
  return name_of(start, kStarts);
}

void describe(SettingVisitor& visit, RunOptions& o) {
  visit.begin("RunOptions");
  visit.group("solver", o.solver);
  visit.choice({.name = "start",
                .what = "impulses to start from; zero if the file has no guess or solution",
                .flag = "--start"},
               o.start, kStarts);
  visit.count({.name = "repeat",
               .what = "number of times to solve each problem; the shortest time counts",
               .unit = "",
               .range = range_from(1),
               .flag = "--repeat",
               .changes_nothing = true},
              o.repeat);
}

void validate(const RunOptions& options) {
  check_ranges(options);
  validate(options.solver);
}

std::vector<std::filesystem::path> problem_files(const std::vector<std::filesystem::path>& given) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : given) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::filesystem::path> inside;
    for (const auto& item : std::filesystem::directory_iterator(path))
      if (item.path().extension() == ".hdf5" || item.path().extension() == ".h5")
        inside.push_back(item.path());
    if (inside.empty()) throw std::runtime_error(path.string() + ": no *.hdf5 or *.h5 in this folder");
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

namespace {

// Nothing, and why in `run`, if it cannot be read.
std::optional<FclibFile> read_problem(const std::filesystem::path& path, ProblemRun& run) {
  try {
    return read_fclib(path);
  } catch (const std::exception& error) {
    run.status = "unreadable";
    run.reason = error.what();
    return std::nullopt;
  }
}

}  // namespace

ProblemRun run_problem(const std::filesystem::path& path, const RunOptions& options) {
  validate(options);
  ProblemRun run{
      .problem = path.stem().string(), .solver = to_string(options.solver.method), .start = options.start};
  std::optional<FclibFile> file = read_problem(path, run);
  if (!file) return run;
  const VecX r0 = start_of(*file, run.start);
  FclibValues answer;
  try {
    answer = std::visit(
        [&](const auto& problem) {
          describe(problem, run);
          return run_on(problem, r0, options, run);
        },
        file->problem);
  } catch (const std::exception& error) {
    run.status = "failed";
    run.reason = error.what();
  }
  if (!options.save.empty() && answer.u.size() > 0) {
    file->solution = answer;
    write_fclib(options.save / path.filename(), *file);
  }
  return run;
}

std::string table_head(const std::vector<std::filesystem::path>& files) {
  char line[256];
  std::snprintf(line, sizeof line, "%-*s %8s %-14s %10s %9s %9s %9s %9s %9s %9s\n", name_width(files),
                "problem", "contacts", "status", "iterations", "scaled", "error", "on |q|", "-u_N m/s",
                "cone N s", "cpu s");
  return line;
}

std::string table_row(const ProblemRun& run, const std::vector<std::filesystem::path>& files) {
  char line[256];
  const int width = name_width(files);
  if (run.status == "unreadable" || run.status == "failed") {
    std::snprintf(line, sizeof line, "%-*.*s %8s %-14s ", width, width, run.problem.c_str(), "",
                  run.status.c_str());
    return line + run.reason + "\n";
  }
  char error[16] = "-";
  if (run.report.error >= 0) std::snprintf(error, sizeof error, "%.2e", run.report.error);
  std::snprintf(line, sizeof line, "%-*.*s %8d %-14s %10d %9.2e %9s %9.2e %9.2e %9.2e %9.2e\n", width, width,
                run.problem.c_str(), run.contacts, run.status.c_str(), run.report.iterations,
                run.scaled_residual, error, run.natural_map_residual, run.physical.worst_normal_approach,
                run.physical.worst_cone_violation, run.cpu_s);
  return line;
}

void write_json(const std::filesystem::path& path, const std::vector<ProblemRun>& runs) {
  Json list = Json::array();
  for (const ProblemRun& run : runs) list.push_back(json_of(run));
  write_whole_file(path, list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace aussois
