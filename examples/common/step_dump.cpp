// SPDX-License-Identifier: Apache-2.0
#include "examples/common/step_dump.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <mutex>
#include <sstream>

#include "geometry/check.hpp"
#include "io/build_info.hpp"
#include "io/fclib_file.hpp"

namespace aussois {
namespace {

// At least `lowest`.
std::int64_t step_number(std::string_view text, const std::string& all, std::int64_t lowest = 1) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  require(error == std::errc() && end == text.data() + text.size() && number >= lowest,
          "--dump-steps '" + all +
              "' must be all, unsolved, 'every N', or a list of steps and ranges such as 3,17,40-45");
  return number;
}

}  // namespace

StepChoice step_choice(const std::string& text) {
  if (text == "all") return {.every = 1};
  if (text == "unsolved") return {.unsolved_only = true, .every = 1};
  if (text.rfind("every ", 0) == 0) return {.every = step_number(std::string_view(text).substr(6), text)};
  StepChoice choice;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string_view word = std::string_view(text).substr(at, comma - at);
    const std::size_t dash = word.find('-');
    const std::int64_t first = step_number(word.substr(0, dash), text),
                       last = dash == word.npos ? first : step_number(word.substr(dash + 1), text, first);
    choice.ranges.emplace_back(first, last);
    at = comma + 1;
  }
  return choice;
}

bool chosen(const StepChoice& choice, std::int64_t step, bool solved) {
  if (choice.unsolved_only && solved) return false;
  if (choice.every > 0) return step % choice.every == 0;
  return std::any_of(choice.ranges.begin(), choice.ranges.end(),
                     [&](const auto& range) { return range.first <= step && step <= range.second; });
}

void add_options(Cli& cli, DumpOptions& options) {
  cli.group("problems");
  cli.option("--dump-problem", options.folder,
             "write one-step problems to this folder (see doc/howto/replay_one_step.md); empty: none");
  cli.option("--dump-steps", options.steps,
             "steps to write: all, unsolved, 'every N', or a list such as 3,17,40-45");
}

StepDump::StepDump(const DumpOptions& options, std::string name)
    : folder_(options.folder), name_(std::move(name)), choice_(step_choice(options.steps)) {
  if (!folder_.empty()) std::filesystem::create_directories(folder_);
}

void StepDump::step(std::int64_t number, const StepReport& report) {
  if (!report.problem || report.problem->problem.laws.empty() || !chosen(choice_, number, report.ok()))
    return;
  const StepProblem& step = *report.problem;
  const SolveReport& solve = step.solution.report;
  char tail[40];
  std::snprintf(tail, sizeof tail, "_%06lld", static_cast<long long>(number));
  std::ostringstream about;
  about << "step " << number << " of " << name_ << ", to t = " << number_text(report.t)
        << " s with h = " << number_text(report.h) << " s; " << to_string(solve.status)
        << ", scaled residual " << number_text(solve.residual) << "; guess 1: warm start"
        << (is_solved(solve.status) ? "\n" : ", guess 2: the best that was found\n") << build_info();
  FclibFile file{.problem = step.problem,
                 .title = name_ + tail,
                 .description = about.str(),
                 .math_info = "M v = H r + G l + f, G^T v + b = 0, u = H^T v + w; rows: normal, tangents",
                 .guesses = {{.r = step.start}}};
  FclibValues answer{
      .r = step.solution.r, .u = step.solution.u, .v = step.solution.v, .l = step.solution.lambda};
  if (is_solved(solve.status))
    file.solution = std::move(answer);
  else
    file.guesses.push_back(std::move(answer));
  static std::mutex one_at_a_time;  // HDF5 need not be built for threads
  const std::lock_guard lock(one_at_a_time);
  write_fclib(folder_ / (name_ + tail + ".hdf5"), file);
  ++written_;
}

}  // namespace aussois
