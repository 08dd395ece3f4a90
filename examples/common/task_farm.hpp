// SPDX-License-Identifier: Apache-2.0
// Tasks handed out to the ranks of an MPI job, one by one as they come asking: rank 0 hands out, the others
// work. A task leaves what it makes in files; nothing else travels.
#pragma once

#include <functional>

namespace aussois {

/// Whether this build knows MPI: AUSSOIS_WITH_MPI.
bool has_task_farm();

/// Calls work(task) for every task in [0, count), each on one rank of the job, and ends MPI: once in a
/// program. Alone in its job, or without MPI, rank 0 does them all. True on rank 0, which goes on when all
/// tasks are done; false on the others.
bool farm_out(int count, const std::function<void(int task)>& work);

}  // namespace aussois
