// SPDX-License-Identifier: Apache-2.0
#include "geometry/parallel.hpp"

#include <algorithm>
#include <atomic>

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
  // oneTBB hands tasks over and back in order; this repeats it for the thread sanitizer.
  std::atomic<int> order{0};
  const auto task = [&](int i) {
    order.load(std::memory_order_acquire);
    f(i);
    order.fetch_add(1, std::memory_order_release);
  };
  order.store(1, std::memory_order_release);
  arena.execute([&] { tbb::parallel_for(0, n, task, tbb::simple_partitioner{}); });
  order.load(std::memory_order_acquire);
}

}  // namespace aussois
