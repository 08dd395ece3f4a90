// SPDX-License-Identifier: Apache-2.0
// The meshes in AUSSOIS_DATA_DIR.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

namespace aussois {

/// All of them, those that repair has to mend included; sorted.
inline std::vector<std::filesystem::path> shared_meshes(const std::filesystem::path& data) {
  std::vector<std::filesystem::path> out;
  for (const char* folder : {"meshes", "meshes/broken"})
    for (const auto& entry : std::filesystem::directory_iterator(data / folder))
      if (const auto extension = entry.path().extension(); extension == ".obj" || extension == ".stl")
        out.push_back(entry.path());
  std::ranges::sort(out);
  return out;
}

}  // namespace aussois
