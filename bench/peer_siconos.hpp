// SPDX-License-Identifier: Apache-2.0
// The peer for solvers: Siconos Numerics [Acary2019] on the same problem, judged by our residual. Every
// solver runs in a child process of its own: some print, some exit, some never return.
#pragma once

#include <string>
#include <vector>

#include "nsgs/friction_problem.hpp"

namespace aussois {

struct SiconosRun {
  bool solved = false;
  std::string failure{};     // why not: "residual", "time", "signal 11", "exit 1"
  double cpu_s = 0;          // of the driver's call, the fastest of several
  int iterations = 0;        // as Siconos counts them
  double residual = 0;       // ours, of the best r that it gave; infinity if it never returned
  double own_tolerance = 0;  // the tolerance that Siconos needed
};

/// Those that apply to the laws of the problem, its default solver first; none for mixed laws.
std::vector<std::string> siconos_solvers(const LocalProblem& problem);

/// From r = 0, W in rows of blocks (dense for the few solvers that require it). Siconos stops on a residual
/// of its own, relative to the largest of |q|, |r|, |u|, which can be far too small: on
/// fc2d_granularflowonwall_00667_00000 it is 4e-19 where ours is 0.1. So it runs with `tolerance` times 100,
/// 32, 10, 3.2, ... until our scaled_residual meets `tolerance`; that run counts, the others do not. No run
/// may take longer than `time_limit` [s of CPU time]; `budget` [s] of fastest_call is for repeats.
SiconosRun run_siconos(const LocalProblem& problem, const std::string& solver, double tolerance,
                       double time_limit, double budget);

}  // namespace aussois
