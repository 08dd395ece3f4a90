// SPDX-License-Identifier: Apache-2.0
// Splits the time of a step among its stages.
#pragma once

#include "integrators/step_report.hpp"

namespace aussois {

class StageClock {
 public:
  StageClock(Stage first, bool cpu) : stage_(first), cpu_(cpu), begin_(time_now(cpu)) {}
  /// From here on the time is that of `stage`.
  void enter(Stage stage) {
    book();
    stage_ = stage;
  }
  /// Ends the last stage and adds all times to `sum`.
  void add_to(StageTimes& sum) {
    book();
    add(times_, sum);
  }

 private:
  void book() {
    const StageTime now = time_now(cpu_);
    times_[stage_].wall += now.wall - begin_.wall;
    times_[stage_].cpu += now.cpu - begin_.cpu;
    begin_ = now;
  }

  Stage stage_;
  bool cpu_;
  StageTime begin_;
  StageTimes times_{};
};

}  // namespace aussois
