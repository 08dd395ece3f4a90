// SPDX-License-Identifier: Apache-2.0
// A solver on a problem in a process of its own, which has so much time and no more.
#pragma once

#include <filesystem>

#include "examples/studies/friction/profile_result.hpp"

namespace aussois {

/// run_problem in a process of its own that is ended after `time_limit` seconds of CPU time, reading
/// and judging included: status time_limit. A solver that crashes costs its problem only: status crashed.
/// Returns status interrupted after SIGINT or SIGTERM.
ProfileResult run_limited(const std::filesystem::path& path, const RunOptions& options, double time_limit);

}  // namespace aussois
