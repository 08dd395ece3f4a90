// SPDX-License-Identifier: Apache-2.0
// Keeps a thing that takes long to make in a folder, under a key made of what it follows from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace aussois {

/// What the folder did.
struct CacheUse {
  bool loaded = false;           // from `file`; otherwise made
  std::filesystem::path file{};  // where the thing is kept; empty without a cache
  bool kept = false;             // `file` holds it now
  std::string warning{};         // why a file could not be used or written; the thing is good
};

/// "loaded from FILE", or "prepared, kept in FILE", or "prepared" if it is not kept (the warning says why).
std::string to_string(const CacheUse& use);

/// Reads FOLDER/KEY.h5 if it is there. Otherwise, or if reading throws a std::runtime_error, makes the thing
/// and writes it. A folder that does not work is a warning. An empty path: only makes.
CacheUse use_folder(const std::filesystem::path& folder, std::uint64_t key,
                    const std::function<void(const std::filesystem::path&)>& read,
                    const std::function<void()>& make,
                    const std::function<void(const std::filesystem::path&)>& write);

}  // namespace aussois
