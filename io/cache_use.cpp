// SPDX-License-Identifier: Apache-2.0
#include "io/cache_use.hpp"

#include <stdexcept>

#include "io/text.hpp"

namespace aussois {

CacheUse use_folder(const std::filesystem::path& folder, std::uint64_t key,
                    const std::function<void(const std::filesystem::path&)>& read,
                    const std::function<void()>& make,
                    const std::function<void(const std::filesystem::path&)>& write) {
  CacheUse out;
  if (folder.empty()) {
    make();
    return out;
  }
  out.file = folder / (hex_text(key) + ".h5");
  std::error_code ignored;
  if (std::filesystem::exists(out.file, ignored)) {
    try {
      read(out.file);
      out.loaded = out.kept = true;
      return out;
    } catch (const std::runtime_error& e) {
      out.warning = std::string(e.what()) + "; prepared again";
    }
  }
  make();
  try {
    std::filesystem::create_directories(folder);
    write(out.file);
    out.kept = true;
  } catch (const std::runtime_error& e) {
    if (!out.warning.empty()) out.warning += "; ";
    out.warning += std::string(e.what()) + "; not kept";
  }
  return out;
}

std::string to_string(const CacheUse& use) {
  if (use.loaded) return "loaded from " + use.file.string();
  return use.kept ? "prepared, kept in " + use.file.string() : "prepared";
}

}  // namespace aussois
