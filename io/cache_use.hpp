// SPDX-License-Identifier: Apache-2.0
// Says what a folder of kept files did for one thing that was needed.
#pragma once

#include <filesystem>
#include <string>

namespace aussois {

struct CacheUse {
  bool loaded = false;           // from `file`; otherwise made
  std::filesystem::path file{};  // where the thing is kept; empty without a cache
  bool kept = false;             // `file` holds it now
  std::string warning{};         // why a file could not be used or written; the thing is good
};

/// "loaded from FILE", or "prepared, kept in FILE", or "prepared" if it is not kept (the warning says why).
std::string to_string(const CacheUse& use);

}  // namespace aussois
