// SPDX-License-Identifier: Apache-2.0
// Measures the cost of one problem with our automatic solver and with every solver of Siconos that applies,
// from r = 0 and judged by our scaled residual: CPU time of one thread, the fastest of several calls.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bench/peer_siconos.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

struct SolverCostOptions {
  double tolerance = 1e-8;  // the problem is solved to this one
  double coarse = 1e-4;     // and to this one, against Siconos' default
  double time_limit = 10;   // of one run of Siconos [s of CPU time]
  double budget = 0.05;     // for repeats of one measurement [s]
};

struct OurRun {
  SolveReport report{};
  bool solved = false;  // by the judge, from r alone
  double cpu_s = 0;
};

struct NamedRun {
  std::string solver{};
  SiconosRun run{};
};

struct ProblemCost {
  std::string name{}, form{};  // local, global
  int contacts = 0, rows = 0;
  OurRun ours{}, ours_coarse{};  // of solve(LocalProblem)
  // A global problem is condensed before either clock starts. The time of that, and ours from the bodies:
  double condense_s = std::numeric_limits<double>::quiet_NaN();
  OurRun ours_global{};
  std::vector<NamedRun> siconos{};  // at `tolerance`; empty where Siconos or a solver for the laws is missing
  std::vector<NamedRun> nsgs_coarse{};  // its default at `coarse`: one, or none
};

/// The fastest that solved it; nullptr if none did.
const NamedRun* best_siconos(const ProblemCost& cost);

/// Ours to the best of Siconos, to its default at the coarse tolerance; NaN unless both solved it.
double ratio_to_best(const ProblemCost& cost);
double ratio_to_nsgs(const ProblemCost& cost);
/// solve(FrictionProblem) to condense() and the best of Siconos; NaN for local problems.
double ratio_from_bodies(const ProblemCost& cost);

/// `step(what)` is called with the name of the next part and returns whether to go on. If not, the result is
/// not to be used. Throws std::runtime_error for a file that cannot be read.
ProblemCost measure_problem(const std::filesystem::path& file, const SolverCostOptions& options,
                            const std::function<bool(const std::string&)>& step);

}  // namespace aussois
