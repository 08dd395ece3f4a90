// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/stage_clock.hpp"

#include <chrono>
#include <ctime>

namespace aussois {

void add(const StageTimes& part, StageTimes& sum) {
  for (std::size_t i = 0; i < part.of.size(); ++i) {
    sum.of[i].wall += part.of[i].wall;
    sum.of[i].cpu += part.of[i].cpu;
  }
}

double seconds_of(const StageTimes& times, std::initializer_list<Stage> stages) {
  double sum = 0;
  for (const Stage stage : stages) sum += times[stage].wall;
  return sum;
}

StageTime time_now(bool cpu) {
  StageTime out{
      .wall = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count()};
  if (!cpu) return out;
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  out.cpu = double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
  return out;
}

StageTime time_since(const StageTime& begin, bool cpu) {
  const StageTime now = time_now(cpu);
  return {now.wall - begin.wall, now.cpu - begin.cpu};
}

}  // namespace aussois
