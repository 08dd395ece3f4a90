// SPDX-License-Identifier: Apache-2.0
// What --resume and --resume-anyway do alike in every driver that has them.
#pragma once

#include "examples/common/driver.hpp"
#include "io/checkpoint.hpp"
#include "io/run_file.hpp"

namespace aussois {

/// As read_checkpoint; that of another program is read with --resume-anyway only, and told on stderr.
Checkpoint checkpoint_to_resume(const CommonOptions& options, const std::filesystem::path& path,
                                std::uint64_t fingerprint);

/// Says in the notes of the run, as `continued_by`, that another program began it: `before`, up to step
/// `step`.
void note_other_program(RunWriter& run, const std::string& before, std::int64_t step);

}  // namespace aussois
