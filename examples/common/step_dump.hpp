// SPDX-License-Identifier: Apache-2.0
// Problems of chosen steps as files that solve_friction_problem and other codes read: doc/howto/
// replay_one_step.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "examples/common/driver.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

/// Which steps: "all", "unsolved" (those whose solve did not converge, or that were refused), "every 10", or
/// numbers and ranges between commas: "3,17,40-45".
struct StepChoice {
  bool unsolved_only = false;
  std::int64_t every = 0;                                       // 0: by the ranges
  std::vector<std::pair<std::int64_t, std::int64_t>> ranges{};  // first, last
};
/// Throws std::invalid_argument with the word that is none of these.
StepChoice step_choice(const std::string& text);
bool chosen(const StepChoice& choice, std::int64_t step, bool solved);

struct DumpOptions {
  std::filesystem::path folder{};  // empty: no dump
  std::string steps = "all";
};
/// The options --dump-problem and --dump-steps, in a group of their own.
void add_options(Cli& cli, DumpOptions& options);

class StepDump {
 public:
  /// Makes the folder. Throws std::invalid_argument for a bad choice of steps.
  StepDump(const DumpOptions& options, std::string name);
  bool wants_problems() const { return !folder_.empty(); }  // for StepOptions::keep_problem
  /// Writes FOLDER/NAME_000017.hdf5 if step 17 is chosen and has a problem with contacts: the warm start is
  /// its guess, the answer its solution, or a second guess if it did not converge.
  void step(std::int64_t number, const StepReport& report);
  int written() const { return written_; }

 private:
  std::filesystem::path folder_{};
  std::string name_{};
  StepChoice choice_{};
  int written_ = 0;
};

}  // namespace aussois
