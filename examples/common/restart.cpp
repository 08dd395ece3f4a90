// SPDX-License-Identifier: Apache-2.0
#include "examples/common/restart.hpp"

#include <cstdio>

#include "io/build_info.hpp"

namespace aussois {

Checkpoint checkpoint_to_resume(const CommonOptions& options, const std::filesystem::path& path,
                                std::uint64_t fingerprint) {
  Checkpoint checkpoint =
      read_checkpoint(path, fingerprint, options.resume_anyway ? OtherProgram::accept : OtherProgram::refuse);
  if (checkpoint.program != program_version())
    std::fprintf(stderr, "%s: written by %s, continued by %s: the bits of this run are those of neither\n",
                 path.c_str(), checkpoint.program.c_str(), program_version().c_str());
  return checkpoint;
}

void note_other_program(RunWriter& run, const std::string& before, std::int64_t step) {
  if (before == program_version()) return;
  run.note("continued_by", program_version() + " after step " + std::to_string(step) + " of " + before);
}

}  // namespace aussois
