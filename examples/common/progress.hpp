// SPDX-License-Identifier: Apache-2.0
// How far a run has come, on stderr: a line that is rewritten at most ten times a second on a terminal, with
// the time left; elsewhere (a log file) a line after 10 s, and one each time the run has doubled.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace aussois {

/// "12 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds);

class Progress {
 public:
  enum class Style { none, terminal, log };
  static Style style_of_stderr(bool quiet);

  /// `total` in whatever `at` counts in (simulated seconds, steps), > 0.
  Progress(std::string what, double total, Style style);
  ~Progress();  // ends the line on a terminal
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Say it as often as you like; `note` is a few words on the present step.
  void at(double done, std::string_view note = {});
  /// The line for `done` after `elapsed` seconds, without line end: "drop_part  42 %  1 min 03 s left  note".
  std::string line(double done, double elapsed, std::string_view note) const;
  /// Does a log get a line after `elapsed` seconds? Nothing of what is done before the first is due.
  bool due_in_log(double done, double elapsed);

 private:
  static constexpr double kFirstLine = 10;  // in a log [s]
  using Clock = std::chrono::steady_clock;
  std::string what_{};
  double total_ = 1;
  Style style_ = Style::none;
  Clock::time_point start_ = Clock::now(), shown_{};
  double next_ = kFirstLine;  // line of a log [s]
  std::size_t width_ = 0;     // of the line on the terminal
};

}  // namespace aussois
