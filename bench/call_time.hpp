// SPDX-License-Identifier: Apache-2.0
// Measures the CPU time of a call of a microsecond to ten seconds, on a machine with other load.
#pragma once

#include <algorithm>
#include <limits>
#include <time.h>

namespace aussois {

/// CPU time of this thread [s]. The clock of a process with a limit ticks every few ms only.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Seconds of one call, in the fastest of several batches. `prepare(n)` makes what n calls need, `call(x)`
/// uses up one of them; only calls are timed. Batches are long beside the 1 us that reading the clock takes;
/// there are 3 to 25 of them within `budget`. A call that takes more than a fifth of the budget by `about` is
/// made once more.
template <class Prepare, class Call>
double fastest_call(double about, double budget, const Prepare& prepare, const Call& call) {
  const int batch = std::clamp(int(1e-4 / std::max(about, 1e-7)), 1, 50),
            batches = about > 0.2 * budget ? 1 : std::clamp(int(budget / (about * batch)), 3, 25);
  double fastest = about;
  for (int i = 0; i < batches; ++i) {
    auto prepared = prepare(batch);
    const double begin = cpu_seconds();
    for (auto& x : prepared) call(x);
    fastest = std::min(fastest, (cpu_seconds() - begin) / batch);
  }
  return fastest;
}

}  // namespace aussois
