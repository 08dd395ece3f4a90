// SPDX-License-Identifier: Apache-2.0
// What a solver took on a problem, kept in a file of its own: an interrupted study continues where it
// stopped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "examples/studies/friction/problem_run.hpp"

namespace aussois {

/// Which result it is: another file, option or program makes another result.
struct ProfileKey {
  std::uint64_t digest = 0;  // of the bytes of the problem's file
  RunOptions options{};
  std::uint64_t program = 0;  // program_digest()
};

struct ProfileResult {
  std::string status{};  // of SolveStatus, or time_limit, crashed, unreadable, failed
  bool solved = false;
  int iterations = 0;
  double scaled_residual = std::numeric_limits<double>::quiet_NaN();  // NaN: not judged
  double natural_map_residual = std::numeric_limits<double>::quiet_NaN();
  double cpu_s = 0;       // of solve()
  double time_limit = 0;  // that it had, for all of its process [s]
  int contacts = 0;
  std::string problem{};
};

ProfileResult result_of(const ProblemRun& run);

std::uint64_t file_digest(const std::filesystem::path& path);  // of a missing file: 0

/// All of a result as JSON text, and back to the last bit; the latter throws std::exception for other text.
std::string to_json(const ProfileResult& result);
ProfileResult profile_result_in(const std::string& json);

/// FOLDER/0123456789abcdef_nsgs_1e-08_fedcba9876543210.json: digest of the problem, solver, tolerance, digest
/// of all options. Results of another program are written over.
std::filesystem::path profile_result_file(const std::filesystem::path& folder, const ProfileKey& key);
void write_profile_result(const std::filesystem::path& folder, const ProfileKey& key,
                          const ProfileResult& result);
/// Nothing: not done yet, damaged, or given up by a smaller limit than this.
std::optional<ProfileResult> read_profile_result(const std::filesystem::path& folder, const ProfileKey& key,
                                                 double time_limit);

}  // namespace aussois
