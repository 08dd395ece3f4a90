// SPDX-License-Identifier: Apache-2.0
// Where the steps of a run spend their time: for each stage the median, the 99th percentile and the largest.
#pragma once

#include <array>
#include <mutex>
#include <string>
#include <vector>

#include "integrators/step_report.hpp"
#include "io/summary.hpp"

namespace aussois {

/// Milliseconds a step.
struct StageFigures {
  std::string stage{};
  double p50 = 0, p99 = 0, most = 0, mean = 0;
  double cpu_p50 = 0, cpu_p99 = 0, cpu_most = 0, cpu_mean = 0;
};

/// The times of all steps of a run, which were taken with StepOptions::profile. Means and largest times are
/// of all steps; medians and percentiles of every n-th, once there are more than kMostSteps.
class StepProfile {
 public:
  static constexpr std::size_t kMostSteps = std::size_t{1} << 17;
  /// `recording`: what it took to record the step, or nothing.
  void add(const StepReport& report, const StageTime& recording = {});
  std::size_t steps() const { return steps_; }
  /// The stages in order; then `other`, what is left of the step; `recording`; `step`, all but recording.
  std::vector<StageFigures> figures() const;
  /// The most that the scheme kept from one step to the next [bytes].
  std::size_t kept_bytes() const { return kept_bytes_; }

 private:
  static constexpr std::size_t kColumns = std::size(kStages) + 3;
  using Row = std::array<StageTime, kColumns>;
  void thin_out();

  std::vector<Row> rows_{};  // of every stride_-th step [s]
  Row sum_{}, most_{};       // of all
  std::size_t steps_ = 0, stride_ = 1, kept_bytes_ = 0;
};

/// The same for many runs that are taken at once.
class SharedProfile {
 public:
  void add(const StepReport& report);
  StepProfile all() const;

 private:
  mutable std::mutex mutex_{};
  StepProfile profile_{};
};

/// A line per stage, and one for what is kept from step to step.
std::string table_of(const StepProfile& profile);
/// Sets profile_stages, a list each of wall and CPU times [ms] in that order, and profile_kept_bytes; nothing
/// without steps.
void set_profile(const StepProfile& profile, Summary& summary);

}  // namespace aussois
