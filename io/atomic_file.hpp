// SPDX-License-Identifier: Apache-2.0
// Writes files so that they exist only when they are complete: next to their place under a temporary name,
// synced to the disk, then renamed. Whatever ends the program or the machine leaves the old file, the new
// one, or none, never a part of one; a killed process may leave a *.tmp.
//
// A file that grows with a run (run.h5, steps.csv) is PATH.tmp until it is complete, so that --resume finds
// it. Two runs cannot write the same one: the second is refused.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace aussois {

/// Calls `write` with the name of a file to create, which no other process uses, and then puts that file in
/// the place of `path`. Passes on whatever `write` throws; throws std::runtime_error, naming the path and the
/// reason, if the file cannot be synced to the disk or renamed. The temporary file is then removed.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Writes `content` (bytes) to `path`, as write_atomically does.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// "DIR/name.tmp" for "DIR/name": a file that grows until it is renamed.
std::filesystem::path growing_name(const std::filesystem::path& path);

/// Syncs the complete file to the disk, renames it to `path`, replacing what was there, and syncs the new
/// name to the disk. Throws std::runtime_error naming both.
void publish_file(const std::filesystem::path& complete, const std::filesystem::path& path);

/// Syncs what was written to a file to the disk. Throws std::runtime_error with path and reason.
void sync_to_disk(const std::filesystem::path& path);

/// The right to be the only writer of a growing file, for as long as this object lives. HDF5 locks the files
/// that it writes in the same way (flock). On a file system without locks, every writer has the right.
class WriterLock {
 public:
  WriterLock() = default;
  /// Locks the file at `path`; holds no lock if there is no file. Throws std::runtime_error with the path if
  /// another writer has it.
  explicit WriterLock(const std::filesystem::path& path);
  ~WriterLock();
  WriterLock(WriterLock&& other) noexcept;
  WriterLock& operator=(WriterLock&& other) noexcept;

  /// Removes a file that a run left and that no run continues; a new one may be made while this lives.
  void remove_file();

 private:
  std::filesystem::path path_{};
  int descriptor_ = -1;
};

}  // namespace aussois
