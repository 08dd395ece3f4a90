// SPDX-License-Identifier: Apache-2.0
// The loop that all sweeping methods share: step, ask the judge when it is due, keep the best iterate, stop
// (FIX-1). With a memory it also tries Anderson acceleration of the last steps (AA-1). Private to nsgs.
#pragma once

#include <functional>
#include <utility>

#include "nsgs/anderson.hpp"
#include "nsgs/method.hpp"

namespace aussois {

/// Moves r by one step of a method; W holds the velocities of r. Returns the size of the change.
using Step = std::function<double(VecX& r)>;

class FixedPoint {
 public:
  FixedPoint(Delassus& W, const Iterate& start, Method by, int memory, Step step);

  /// Takes one step; true if the judge was asked. `last` means that no other step will follow.
  bool advance(double tolerance, bool last);
  /// To call after W was used for something else: makes its velocities those of now() again.
  void resume() { W_.velocity(now_.r); }

  /// Continues from `other` if it is better than the present iterate.
  void go_on_from(Iterate other);

  const Iterate& now() const { return now_; }  // the last iterate that was judged
  const Iterate& best() const { return best_.iterate(); }
  void offer(Iterate other) { best_.offer(std::move(other), steps_); }
  bool finite() const { return now_.residual < kInf; }
  bool stagnated() const { return best_.stagnated(steps_); }

 private:
  std::optional<Iterate> accelerated(const VecX& after);

  Delassus& W_;
  Iterate now_{};
  BestSoFar best_;
  VecX r_{};  // the present impulses; now_.r if the steps are accelerated
  int memory_ = 0;
  Anderson anderson_;
  Step step_;
  JudgeSchedule schedule_{};
  int steps_ = 0;
};

Iterate fixed_point(Delassus& W, const Iterate& start, Method by, const SolverOptions& options,
                    SolveReport& report, const Step& step);

}  // namespace aussois
