// SPDX-License-Identifier: Apache-2.0
#include "bench/solver_report.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "examples/common/gnuplot.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;
using Ratio = double (*)(const ProblemCost&);
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Prints a dash for a number that does not exist.
std::string cell(const char* format, int width, double value) {
  return std::isfinite(value) ? formatted(format, width, value) : formatted("%*s", width, "-");
}

bool counts(const ProblemCost& cost) {
  return cost.contacts > kFewContacts;
}

void add_ratios(std::vector<Bar>& out, const std::vector<ProblemCost>& costs, Ratio ratio, Bar worst,
                Bar mean) {
  worst.value = -kInf;
  double sum = 0, count = 0;
  for (const ProblemCost& cost : costs) {
    const double r = ratio(cost);
    if (!counts(cost) || !(r > 0)) continue;
    if (r > worst.value) worst.value = r, worst.where = cost.name;
    sum += std::log(r), ++count;
  }
  if (count == 0) return;
  mean.value = std::exp(sum / count);
  out.push_back(worst);
  out.push_back(mean);
}

double best_ms(const ProblemCost& cost) {
  const NamedRun* best = best_siconos(cost);
  return best ? 1e3 * best->run.cpu_s : kNone;
}
double ours_ms(const OurRun& run) {
  return run.solved ? 1e3 * run.cpu_s : kNone;
}
double nsgs_ms(const ProblemCost& cost) {
  return !cost.nsgs_coarse.empty() && cost.nsgs_coarse.front().run.solved
             ? 1e3 * cost.nsgs_coarse.front().run.cpu_s
             : kNone;
}
std::string best_name(const ProblemCost& cost) {
  const NamedRun* best = best_siconos(cost);
  return best ? best->solver : cost.siconos.empty() ? "-" : "none";
}

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
Json json_of(const OurRun& run) {
  return {{"solved", run.solved},
          {"ms", number(1e3 * run.cpu_s)},
          {"iterations", run.report.iterations},
          {"newton_iterations", run.report.newton_iterations},
          {"found_by", to_string(run.report.found_by)},
          {"residual", number(run.report.residual)}};
}
Json json_of(const SiconosRun& run) {
  if (!run.solved) return {{"solved", false}, {"failure", run.failure}, {"residual", number(run.residual)}};
  return {{"solved", true},
          {"ms", 1e3 * run.cpu_s},
          {"iterations", run.iterations},
          {"residual", run.residual},
          {"own_tolerance", run.own_tolerance}};
}
Json json_of(const ProblemCost& cost) {
  Json out{{"problem", cost.name},
           {"form", cost.form},
           {"contacts", cost.contacts},
           {"rows", cost.rows},
           {"ms", number(ours_ms(cost.ours))},
           {"ms_siconos", number(best_ms(cost))},
           {"siconos_solver", best_name(cost)},
           {"ratio", number(ratio_to_best(cost))},
           {"ms_coarse", number(ours_ms(cost.ours_coarse))},
           {"ms_nsgs_coarse", number(nsgs_ms(cost))},
           {"ratio_coarse", number(ratio_to_nsgs(cost))},
           {"ms_condense", number(1e3 * cost.condense_s)},
           {"ms_from_bodies", number(ours_ms(cost.ours_global))},
           {"ratio_from_bodies", number(ratio_from_bodies(cost))},
           {"ours", json_of(cost.ours)},
           {"ours_coarse", json_of(cost.ours_coarse)},
           {"siconos", Json::object()}};
  for (const NamedRun& named : cost.siconos) out["siconos"][named.solver] = json_of(named.run);
  for (const NamedRun& named : cost.nsgs_coarse) out["siconos_coarse"][named.solver] = json_of(named.run);
  return out;
}

}  // namespace

std::vector<Bar> solver_verdicts(const std::vector<ProblemCost>& costs) {
  std::vector<Bar> out;
  Bar unsolved{"unsolved", "problems unsolved by us", "", 0, 0};
  for (const ProblemCost& cost : costs)
    if (!cost.ours.solved || !cost.ours_coarse.solved) ++unsolved.value, unsolved.where = cost.name;
  out.push_back(unsolved);
  add_ratios(
      out, costs, ratio_to_nsgs,
      {"worst_ratio_to_nsgs", "coarse tolerance: longest to Siconos' default", "", 0, 1},
      {"geometric_mean_ratio_to_nsgs", "coarse tolerance: to Siconos' default, geometric mean", "", 0, 1});
  add_ratios(out, costs, ratio_to_best,
             {"worst_ratio_to_best", "longest to the best solver of Siconos", "", 0, 3},
             {"geometric_mean_ratio_to_best", "to the best solver of Siconos, geometric mean", "", 0, 0.5});
  return out;
}

std::string siconos_line(const std::vector<ProblemCost>& costs, const SolverCostOptions& options) {
  int asked = 0, solved = 0, coarse = 0;
  for (const ProblemCost& cost : costs) {
    asked += !cost.siconos.empty();
    solved += best_siconos(cost) != nullptr;
    coarse += std::isfinite(nsgs_ms(cost));
  }
  if (asked == 0) return "Siconos: not measured\n";
  return formatted(
      "Siconos within %g s: the best of its solvers %d of %d problems at %g, its default %d at %g\n",
      options.time_limit, solved, asked, options.tolerance, coarse, options.coarse);
}

std::string solver_table_head(const SolverCostOptions& options) {
  return formatted("%-44s %4s %8s %7s %7s %9s %9s %-18s %7s %9s %9s %7s %8s\n", "problem", "form", "contacts",
                   "sweeps", "Newton", formatted("%g ms", options.tolerance).c_str(), "Siconos", "with",
                   "ratio", formatted("%g ms", options.coarse).c_str(), "its NSGS", "ratio", "bodies");
}

std::string line_of(const ProblemCost& cost) {
  return formatted("%-44s %4s %8d %7d %7d ", cost.name.c_str(), cost.form == "global" ? "M,H" : "W",
                   cost.contacts, cost.ours.report.iterations, cost.ours.report.newton_iterations) +
         cell("%*.4g ", 9, ours_ms(cost.ours)) + cell("%*.4g ", 9, best_ms(cost)) +
         formatted(" %-18s", best_name(cost).c_str()) + cell("%*.3f ", 7, ratio_to_best(cost)) +
         cell("%*.4g ", 9, ours_ms(cost.ours_coarse)) + cell("%*.4g ", 9, nsgs_ms(cost)) +
         cell("%*.3f ", 7, ratio_to_nsgs(cost)) + cell("%*.3f", 8, ratio_from_bodies(cost)) + "\n";
}

void write_solver_json(const std::filesystem::path& path, const std::vector<ProblemCost>& costs,
                       const SolverCostOptions& options) {
  Json out{{"tolerance", options.tolerance},
           {"coarse_tolerance", options.coarse},
           {"time_limit_s", options.time_limit},
           {"problems", Json::array()},
           {"summary", Json::object()}};
  for (const ProblemCost& cost : costs) out["problems"].push_back(json_of(cost));
  bool pass = true;
  for (const Bar& v : solver_verdicts(costs)) {
    out["summary"][v.key] = {
        {"value", v.value}, {"wanted", v.wanted}, {"pass", v.pass()}, {"problem", v.where}};
    pass = pass && v.pass();
  }
  out["summary"]["pass"] = pass;
  write_whole_file(path, out.dump(1) + "\n");
}

bool write_solver_plot(const std::filesystem::path& dir, std::vector<ProblemCost> costs) {
  std::ranges::stable_sort(costs, {}, &ProblemCost::contacts);
  std::string csv =
      "problem,contacts,ms,ms_siconos,ratio,ms_coarse,ms_nsgs_coarse,ratio_coarse,siconos_solver\n";
  for (const ProblemCost& cost : costs) {
    csv += cost.name;
    for (const double value : {double(cost.contacts), ours_ms(cost.ours), best_ms(cost), ratio_to_best(cost),
                               ours_ms(cost.ours_coarse), nsgs_ms(cost), ratio_to_nsgs(cost)}) {
      csv += ',';
      append_number(csv, value);
    }
    csv += ',' + best_name(cost) + '\n';
  }
  write_whole_file(dir / "bench_solver.csv", csv);
  write_whole_file(
      dir / "bench_solver.gp",
      "# draws bench_solver.png: gnuplot bench_solver.gp\n"
      "set terminal pngcairo size 1300,760 font ',11'; set output 'bench_solver.png'\n"
      "set datafile separator ','; set datafile missing 'nan'; set logscale y; set format y '10^{%L}'\n"
      "set grid y; set xtics rotate by -50 noenhanced font ',8'; set rmargin 10; set bmargin 16; set key top "
      "left\n"
      "set ylabel 'CPU time on one thread [ms]'; set xrange [-0.5:" +
          std::to_string(costs.size()) +
          " - 0.5]\n"
          "plot 'bench_solver.csv' every ::1 using 0:7:xtic(1) with points pt 9 ps 1.3 lc rgb '#bbbbbb' "
          "title 'Siconos, its default, coarse tolerance', \\\n"
          "     '' every ::1 using 0:4 with points pt 5 ps 1.3 lc rgb '#c0702a' "
          "title 'Siconos, the best of its solvers with hindsight', \\\n"
          "     '' every ::1 using 0:3 with points pt 7 ps 1.3 lc rgb '#1f5fa8' "
          "title 'auto'\n");
  return run_gnuplot(dir, "bench_solver.gp");
}

}  // namespace aussois
