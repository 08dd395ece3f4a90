// SPDX-License-Identifier: Apache-2.0
// Reports the results of bench_solver: a table, verdicts, JSON, CSV, a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/solver_cost.hpp"
#include "bench/verdict.hpp"

namespace aussois {

/// Verdicts refer to problems with more contacts: below, a call takes a few microseconds.
inline constexpr int kFewContacts = 10;

/// The number of all problems that we do not solve. Of problems with more than kFewContacts, the worst and
/// the geometric mean of the ratios that could be measured: to Siconos' default at the coarse tolerance, and
/// last to its best solver.
std::vector<Bar> solver_verdicts(const std::vector<ProblemCost>& costs);

/// "Siconos solves 40 of 43 problems with its best solver, ...".
std::string siconos_line(const std::vector<ProblemCost>& costs, const SolverCostOptions& options);

std::string solver_table_head(const SolverCostOptions& options);
std::string line_of(const ProblemCost& cost);

/// {"problems": [{"problem", "contacts", "ms", "ms_siconos", "siconos_solver", "ratio", ...,
/// "siconos": {"nsgs": {...}, ...}}], "summary": {...}}; what was not measured is null.
void write_solver_json(const std::filesystem::path& path, const std::vector<ProblemCost>& costs,
                       const SolverCostOptions& options);

/// DIR/bench_solver.csv, DIR/bench_solver.gp and, if gnuplot is there, DIR/bench_solver.png: milliseconds per
/// problem on a logarithmic scale, by contacts. False: the picture was not drawn.
bool write_solver_plot(const std::filesystem::path& dir, std::vector<ProblemCost> costs);

}  // namespace aussois
