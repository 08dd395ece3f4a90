// SPDX-License-Identifier: Apache-2.0
// What stands for task_farm.cpp in a build without MPI.
#include "examples/common/task_farm.hpp"

namespace aussois {

bool has_task_farm() {
  return false;
}

bool farm_out(int count, const std::function<void(int task)>& work) {
  for (int task = 0; task < count; ++task) work(task);
  return true;
}

}  // namespace aussois
