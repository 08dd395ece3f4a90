// SPDX-License-Identifier: Apache-2.0
// Performance profiles [Dolan2002]: which share of the problems a solver solves within a factor of the best.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aussois {

/// rho_s(tau) = share of the problems p with t_ps <= tau min_s t_ps, for tau >= 1, at every tau where one of
/// them changes.
struct PerformanceProfile {
  std::vector<double> tau{};                 // ascending, the first is 1
  std::vector<std::vector<double>> share{};  // of each solver, at each tau [-]
};

/// cost[s][p] > 0 of solver s on problem p; infinity where it failed. A problem that no solver solves counts
/// in the shares. Throws std::invalid_argument if the solvers have different numbers of problems or a cost
/// is not positive.
PerformanceProfile performance_profile(const std::vector<std::vector<double>>& cost);

/// FOLDER/NAME.csv (tau and a column per solver), FOLDER/NAME.gp, and FOLDER/NAME.png if gnuplot is there:
/// false if not. Throws std::runtime_error with the path.
bool write_profile(const std::filesystem::path& folder, const std::string& name,
                   const std::vector<std::string>& solvers, const PerformanceProfile& profile,
                   const std::string& title);

}  // namespace aussois
