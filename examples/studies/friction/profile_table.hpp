// SPDX-License-Identifier: Apache-2.0
// What many solvers took on many problems, in a text file that grows line by line: an interrupted study
// continues where it stopped.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include "examples/studies/friction/problem_run.hpp"

namespace aussois {

/// Which result it is: another file, solver or tolerance is another result.
struct ProfileKey {
  std::uint64_t digest = 0;  // of the bytes of the problem's file
  std::string solver{};
  double tolerance = 0;
  int max_iterations = 0;
  auto operator<=>(const ProfileKey&) const = default;
};

struct ProfileResult {
  std::string status{};  // of SolveStatus, or time_limit, crashed, unreadable, failed
  bool solved = false;
  int iterations = 0;
  double scaled_residual = std::numeric_limits<double>::quiet_NaN();  // nobody judged
  double natural_map_residual = std::numeric_limits<double>::quiet_NaN();
  double cpu_s = 0;       // of solve()
  double time_limit = 0;  // that it had, for all of its process [s]
  int contacts = 0;
  std::string problem{};
};

ProfileResult result_of(const ProblemRun& run);

std::uint64_t file_digest(const std::filesystem::path& path);  // of a missing file: 0

class ProfileTable {
 public:
  /// Opens or creates it; a last line that is not whole is cut off. Throws std::runtime_error with path and
  /// line if it holds something else.
  explicit ProfileTable(std::filesystem::path path);

  /// nullptr: not done yet, or given up by a smaller limit than this.
  const ProfileResult* find(const ProfileKey& key, double time_limit) const;
  void add(const ProfileKey& key, const ProfileResult& result);  // written at once
  std::size_t size() const { return results_.size(); }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_{};
  std::map<ProfileKey, ProfileResult> results_{};
  std::unique_ptr<std::FILE, CloseFile> file_{};
};

/// The line of the table, without line end, and back; the latter throws std::invalid_argument with the field.
std::string to_line(const ProfileKey& key, const ProfileResult& result);
std::pair<ProfileKey, ProfileResult> from_line(const std::string& line);

/// run_problem in a process of its own that is ended after `time_limit` seconds of CPU time, reading
/// and judging included: status time_limit. A solver that crashes costs its problem only: status crashed.
/// Returns status interrupted after SIGINT or SIGTERM.
ProfileResult run_limited(const std::filesystem::path& path, const RunOptions& options, double time_limit);

}  // namespace aussois
