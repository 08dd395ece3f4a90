// SPDX-License-Identifier: Apache-2.0
// Files that exist only when they are complete: written beside their place under a temporary name, then
// renamed. A killed process leaves the old file, or none, and perhaps a *.tmp. (A power cut may lose the last
// file.)
#pragma once

#include <filesystem>
#include <string_view>

namespace aussois {

/// "DIR/name.tmp" for "DIR/name": the same folder, so that the rename cannot cross file systems.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Renames the finished temporary file to `path`, replacing what was there. Throws std::runtime_error naming
/// both.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& path);

/// Writes `content` (bytes) to `path`. Throws std::runtime_error with path and reason, and removes its
/// temporary file.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

}  // namespace aussois
