// SPDX-License-Identifier: Apache-2.0
#include "examples/common/task_farm.hpp"

#include <chrono>
#include <mpi.h>
#include <thread>

namespace aussois {
namespace {

constexpr int kAsk = 1, kTask = 2;  // tags
constexpr int kNoneLeft = -1;

// Rank 0 sleeps between two looks: MPI_Recv would keep a core busy that could work.
int who_asks() {
  MPI_Status status;
  for (int asked = 0; !asked;) {
    MPI_Iprobe(MPI_ANY_SOURCE, kAsk, MPI_COMM_WORLD, &asked, &status);
    if (!asked) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  MPI_Recv(nullptr, 0, MPI_INT, status.MPI_SOURCE, kAsk, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return status.MPI_SOURCE;
}

void hand_out(int count, int workers) {
  for (int next = 0; workers > 0;) {
    const int rank = who_asks();
    const int task = next < count ? next++ : kNoneLeft;
    if (task == kNoneLeft) --workers;
    MPI_Send(&task, 1, MPI_INT, rank, kTask, MPI_COMM_WORLD);
  }
}

int ask() {
  int task = kNoneLeft;
  MPI_Send(nullptr, 0, MPI_INT, 0, kAsk, MPI_COMM_WORLD);
  MPI_Recv(&task, 1, MPI_INT, 0, kTask, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return task;
}

}  // namespace

bool has_task_farm() {
  return true;
}

bool farm_out(int count, const std::function<void(int task)>& work) {
  int rank = 0, size = 1;
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size == 1)
    for (int task = 0; task < count; ++task) work(task);
  else if (rank == 0)
    hand_out(count, size - 1);
  else
    for (int task = ask(); task != kNoneLeft; task = ask()) work(task);
  MPI_Finalize();
  return rank == 0;
}

}  // namespace aussois
