// SPDX-License-Identifier: Apache-2.0
// The report on many roll-outs: statistics, a table of tosses, a histogram, one toss in the browser.
#pragma once

#include <filesystem>

#include "examples/studies/toss/toss_rollout.hpp"
#include "io/summary.hpp"

namespace aussois {

struct Spread {
  double mean = 0, sd = 0, median = 0;  // sd of the sample
};
Spread spread_of(std::vector<double> values);  // of one or more

/// How many values lie in each bin; the last holds all that is beyond, also what is no number.
std::vector<int> bin_counts(const std::vector<double>& values, double width, int bins);

/// Over the tosses, of (TOSS-2) and (TOSS-3).
struct TossStatistics {
  Spread position{};  // [% of the edge]
  Spread rotation{};  // [deg]
  double loss = 0;    // mean
};
TossStatistics statistics_of(const std::vector<TossRun>& runs);  // of one or more

/// Keys PREFIXposition_error_percent_mean, ..._sd, ..._median (of the edge), PREFIXrotation_error_deg_...,
/// PREFIXloss_mean.
void set_errors(Summary& summary, const std::string& prefix, const TossStatistics& errors);

/// tosses.csv: a row per toss, by the number in its name.
void write_toss_table(const std::filesystem::path& folder, const std::vector<Toss>& tosses,
                      const std::vector<TossRun>& runs);

/// histogram.csv, histogram.gp and, if gnuplot is there, histogram.png; false if it is not.
bool write_toss_histogram(const std::filesystem::path& folder, const std::vector<TossRun>& runs);

/// NAME.html: the toss rolled out once more, every step of it, and the recorded cube beside the simulated
/// one.
void write_toss_replay(const std::filesystem::path& folder, const Toss& toss, const TossWorld& world,
                       const std::string& command_line);

}  // namespace aussois
