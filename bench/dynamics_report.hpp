// SPDX-License-Identifier: Apache-2.0
// Reports the results of bench_dynamics: a table, verdicts, JSON.
#pragma once

#include <filesystem>

#include "bench/dynamics_cost.hpp"
#include "bench/verdict.hpp"

namespace aussois {

/// Error and cost of our kernel on every scene that has bars. An error is compared with its bar over the
/// whole length of its scene or less: errors grow.
std::vector<Bar> dynamics_verdicts(const std::vector<SceneCost>& scenes);

std::string dynamics_table_head();
std::string lines_of(const SceneCost& scene);  // a line per engine

/// {"scenes": [{"scene", "h", "t_end", "t_timed", "engines": {"aussois": {"error", "fall_time", "us",
/// "ratio", ...},
/// ...}}], "summary": {...}}; what does not exist is null. `ratio`: of the time, to Bullet's.
void write_dynamics_json(const std::filesystem::path& path, const std::vector<SceneCost>& scenes);

}  // namespace aussois
