// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/performance_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "examples/common/gnuplot.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/csv_table.hpp"

namespace aussois {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// t_ps / min_s t_ps of every solver, infinity where it failed.
std::vector<std::vector<double>> ratios(std::vector<std::vector<double>> cost, std::size_t problems) {
  for (std::size_t p = 0; p < problems; ++p) {
    double best = kInfinity;
    for (const std::vector<double>& of_solver : cost) best = std::min(best, of_solver[p]);
    for (std::vector<double>& of_solver : cost)
      of_solver[p] = std::isfinite(of_solver[p]) ? of_solver[p] / best : kInfinity;
  }
  return cost;
}

std::string column_name(std::string solver) {
  std::replace_if(
      solver.begin(), solver.end(), [](char c) { return c == ',' || c == '"' || c == '\n'; }, '_');
  return solver;
}

}  // namespace

PerformanceProfile performance_profile(const std::vector<std::vector<double>>& cost) {
  const std::size_t problems = cost.empty() ? 0 : cost.front().size();
  for (const std::vector<double>& of_solver : cost) {
    require_field(of_solver.size() == problems, "problems of a solver", of_solver.size(),
                  ("be " + std::to_string(problems) + " as for the other solvers").c_str());
    for (const double t : of_solver) require_field(t > 0, "cost", t, "be positive, infinity for a failure");
  }
  const std::vector<std::vector<double>> ratio = ratios(cost, problems);
  PerformanceProfile profile{.tau = {1}};
  for (const std::vector<double>& of_solver : ratio)
    std::copy_if(of_solver.begin(), of_solver.end(), std::back_inserter(profile.tau),
                 [](double r) { return std::isfinite(r); });
  std::sort(profile.tau.begin(), profile.tau.end());
  profile.tau.erase(std::unique(profile.tau.begin(), profile.tau.end()), profile.tau.end());
  for (std::vector<double> of_solver : ratio) {
    std::sort(of_solver.begin(), of_solver.end());
    std::vector<double> share;
    for (const double tau : profile.tau)
      share.push_back(double(std::upper_bound(of_solver.begin(), of_solver.end(), tau) - of_solver.begin()) /
                      double(std::max<std::size_t>(problems, 1)));
    profile.share.push_back(std::move(share));
  }
  return profile;
}

bool write_profile(const std::filesystem::path& folder, const std::string& name,
                   const std::vector<std::string>& solvers, const PerformanceProfile& profile,
                   const std::string& title) {
  std::vector<std::string> columns = {"tau"};
  for (const std::string& solver : solvers) columns.push_back(column_name(solver));
  CsvTable csv(folder / (name + ".csv"), columns);
  const double last = 1.5 * profile.tau.back();  // the curves end flat, not in a corner
  for (std::size_t i = 0; i <= profile.tau.size(); ++i) {
    const std::size_t at = std::min(i, profile.tau.size() - 1);
    std::vector<double> row = {i < profile.tau.size() ? profile.tau[i] : last};
    for (const std::vector<double>& share : profile.share) row.push_back(share[at]);
    csv.add(row);
  }
  csv.close();
  std::ostringstream gp;
  gp << "# draws " << name << ".png: gnuplot " << name << ".gp\n"
     << "set terminal pngcairo size 900,600; set output '" << name << ".png'\n"
     << "set datafile separator ','; set key autotitle columnhead outside right noenhanced; set grid\n"
     << "set logscale x; set xrange [1:" << last << "]; set yrange [0:1.02]\n"
     << "set title '" << title << "' noenhanced\n"
     << "set xlabel 'factor tau of the best solver of each problem'; set ylabel 'share of problems solved'\n"
     << "plot for [k=2:" << columns.size() << "] '" << name << ".csv' using 1:k with steps lw 2\n";
  write_whole_file(folder / (name + ".gp"), gp.str());
  return run_gnuplot(folder, name + ".gp");
}

}  // namespace aussois
