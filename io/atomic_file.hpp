// SPDX-License-Identifier: Apache-2.0
// Files that exist only when they are complete: written beside their place under a name of their own, brought
// to the disk, then renamed. Whatever ends the program or the machine leaves the old file, the new one, or
// none, never a part of one; a killed process may leave a *.tmp.
//
// A file that grows with a run (run.h5, steps.csv) is PATH.tmp until it is complete, so that --resume finds
// it. Two runs cannot write the same one: the second is refused.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace aussois {

/// Calls `write` with the name of a file to be made, which no other process has, and puts that file in the
/// place of `path`. Whatever `write` throws goes on to the caller; so does std::runtime_error, naming the
/// path and the reason, if the file cannot be brought to the disk or renamed. The temporary file is gone
/// then.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Writes `content` (bytes) to `path`, as write_atomically does.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// "DIR/name.tmp" for "DIR/name": a file that grows until it is renamed.
std::filesystem::path growing_name(const std::filesystem::path& path);

/// Brings the complete file to the disk, renames it to `path`, replacing what was there, and brings the new
/// name to the disk. Throws std::runtime_error naming both.
void publish(const std::filesystem::path& complete, const std::filesystem::path& path);

/// Brings what was written to a file to the disk. Throws std::runtime_error with path and reason.
void sync_to_disk(const std::filesystem::path& path);

/// The right to be the only writer of a growing file, as long as this lives. HDF5 locks the files that it
/// writes in the same way (flock). Where the file system knows no locks, everybody has the right.
class WriterLock {
 public:
  WriterLock() = default;
  /// Of the file at `path`; no lock if there is none. Throws std::runtime_error with the path if another
  /// writer has it.
  explicit WriterLock(const std::filesystem::path& path);
  ~WriterLock();
  WriterLock(WriterLock&& other) noexcept;
  WriterLock& operator=(WriterLock&& other) noexcept;

  /// Takes the file away that a run left which nobody continues; a new one may be made while this lives.
  void remove_file();

 private:
  std::filesystem::path path_{};
  int descriptor_ = -1;
};

}  // namespace aussois
