// SPDX-License-Identifier: Apache-2.0
#include "geometry/parallel.hpp"

#include <algorithm>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace aussois {

void parallel_for(int n, int threads, const std::function<void(int)>& f) {
  if (threads <= 1 || n <= 1) {
    for (int i = 0; i < n; ++i) f(i);
    return;
  }
  tbb::task_arena arena(std::min(threads, tbb::info::default_concurrency()));
  arena.execute([&] { tbb::parallel_for(0, n, f, tbb::simple_partitioner{}); });
}

}  // namespace aussois
