// SPDX-License-Identifier: Apache-2.0
// Shows the bytes of a whole file. A file without permission to write is mapped: only what is read takes
// memory, and processes share it. Any other is copied, since bytes must not change while they are used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace aussois {

struct FileBytes {
  std::span<const std::byte> bytes{};
  std::shared_ptr<const void> owner{};  // of the bytes
  bool mapped = false;
  std::uint64_t device = 0, inode = 0;  // which file it was when it was opened
};

/// Throws std::runtime_error with path and reason.
FileBytes bytes_of_file(const std::filesystem::path& path);

/// Gives the memory of a mapping back: its pages come again when they are read.
void drop_pages(const FileBytes& bytes);

/// Whether the descriptor is one of the file that the bytes are from.
bool is_file(int descriptor, const FileBytes& bytes);

/// The path of the file that is mapped at this address, null if none is. May be called in a signal handler:
/// if a mapped file is cut off (its owner must permit writing again first), reading the missing part raises
/// SIGBUS there.
const char* mapped_path_at(const void* address);

/// The files that were written while they were mapped, whether they still are or not; each once. What was
/// computed with them may be wrong.
std::vector<std::string> take_files_changed_while_mapped();

/// Takes the right to write from everyone, so that bytes_of_file maps the file. Files of this kind are
/// replaced by renaming another one, never written again.
void forbid_writing(const std::filesystem::path& path);

}  // namespace aussois
