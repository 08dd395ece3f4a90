// SPDX-License-Identifier: Apache-2.0
// Reports the results of bench_lmd: tables, verdicts, JSON, a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/pair_cost.hpp"
#include "bench/verdict.hpp"

namespace aussois {

/// The threshold that verdicts refer to: 1 % of the moving radius.
inline constexpr double kVerdictThreshold = 0.01;

/// Verdicts on all that could be measured: memory, build, growth, the worst ratio, and last the geometric
/// mean of the ratios.
std::vector<Bar> verdicts(const std::vector<PairCost>& pairs);

double ratio_to_fcl(const PairCost& pair);  // at kVerdictThreshold; nan without FCL

std::string header_line();
std::string lines_of(const PairCost& pair);        // a line per threshold
std::string ablation_lines(const PairCost& pair);  // ratios to the query with all tests

/// {"pairs": [{"pair", "contacts", "ms_query", "ms_fcl", "ratio_to_fcl", ..., "thresholds": [...]}],
/// "summary": {...}}; what was not measured is null.
void write_cost_json(const std::filesystem::path& path, const std::vector<PairCost>& pairs);

/// DIR/bench_lmd.csv, DIR/bench_lmd.gp and, if gnuplot is there, DIR/bench_lmd.png: milliseconds per pair at
/// kVerdictThreshold on a logarithmic scale. False: the picture was not drawn.
bool write_cost_plot(const std::filesystem::path& dir, const std::vector<PairCost>& pairs);

}  // namespace aussois
