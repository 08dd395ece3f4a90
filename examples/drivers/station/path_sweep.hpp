// SPDX-License-Identifier: Apache-2.0
// Many assessments: paths of a folder, each at all combinations of swept parameters, on all cores; each is
// kept in a file of its own, and done once.
#pragma once

#include "examples/drivers/assembly/assess_take.hpp"
#include "examples/drivers/station/station_setup.hpp"

namespace aussois {

struct SweepFlags {
  std::vector<std::string> sweeps{};  // words: "mu=0", "0.1", "misalignment=1"
  std::filesystem::path paths{};      // folder; empty: the path of the parts
  std::string shard = "1/1";
  bool any() const { return !sweeps.empty() || !paths.empty(); }
};
void add_options(Cli& cli, SweepFlags& flags);

struct SweepAxis {
  std::string name{};  // a parameter of the session, or misalignment
  std::vector<double> values{};
};
/// "mu=0,0.1" or the words of it. Throws std::invalid_argument naming the word.
std::vector<SweepAxis> sweep_axes(const std::vector<std::string>& words);

struct SweepRow {
  std::filesystem::path path{};
  std::vector<double> values{};  // of the axes
  TakeAssessment assessment{};
  std::string
      problem{};  // why there is no assessment: a file that cannot be read, parts in contact; else empty
};

struct SweepPlan {
  StationFlags station{};
  SweepFlags sweep{};
  double hold = 0.1;   // at the end of a path [s]
  std::string said{};  // flags that the results depend on
  std::filesystem::path out{};
  int threads = 1;
  bool quiet = false;
};
/// The rows of this shard, sorted by path and values; nothing if it was interrupted. Results of an earlier
/// call in the folder `results` are read again.
std::optional<std::vector<SweepRow>> assess_all(const SweepPlan& plan);

/// Header and a line per row.
std::string csv_of(const std::vector<SweepAxis>& axes, const std::vector<SweepRow>& rows);

}  // namespace aussois
