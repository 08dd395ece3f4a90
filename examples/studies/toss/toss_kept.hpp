// SPDX-License-Identifier: Apache-2.0
// Roll-outs of many tosses, and points of a fit, kept in JSON files: a later call in the same folder does
// only what is not there yet, with the same results to the last bit.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "examples/studies/toss/toss_rollout.hpp"

namespace aussois {

struct TossKeep {
  std::filesystem::path folder{};  // made if missing; empty: nothing is kept
  bool read = true;                // false: all is done again, and written again
  std::string choice{};            // choice_text() of the scheme
};

struct TossRuns {
  std::vector<TossRun> runs{};  // without their rows; none if it was stopped
  int known = 0;                // of them read
  double cpu_s = 0;             // of all roll-outs, also those that were read
};
/// Rolls out all tosses, a batch at a time, on threads. Batch 1 is kept in NAME_001.json, beside what it
/// depends on; files of problems have names that begin with "cube_toss_NAME_TOSS". `go_on(done)` is called
/// after each batch and stops the others by returning false.
TossRuns roll_out_all(const std::vector<Toss>& tosses, const TossWorld& world, const WatchFlags& watch,
                      const TossKeep& keep, const std::string& name, int threads,
                      const std::function<bool(int done)>& go_on);

/// A point of a fit that was tried.
struct FitPoint {
  double error = kInf;         // mean over the tosses [m]; infinity: given up
  std::vector<double> each{};  // of every toss; 0 for those that were not rolled out any more
  std::int64_t steps = 0;      // of its roll-outs
  RunAudit audit{};
};
/// Which point: what its result depends on, since the search that led there is one of the same tosses.
struct FitPlace {
  std::span<const Toss> tosses{};
  TossWorld start{};            // of the search, with the steps per row of this stage
  WatchFlags watch{};           // of its roll-outs, without files of problems
  int stage = 0;                // of the search, from 1
  int number = 0;               // in this stage, from 1
  int mu = 0, restitution = 0;  // on the grid
  double bound = kInf;          // of the error: beyond it is given up
};
std::optional<FitPoint> read_point(const TossKeep& keep, const FitPlace& place);
void write_point(const TossKeep& keep, const FitPlace& place, const FitPoint& point);

}  // namespace aussois
