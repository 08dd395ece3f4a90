// SPDX-License-Identifier: Apache-2.0
// Results that an earlier call kept in a JSON file.
#pragma once

#include <exception>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "io/text.hpp"

namespace aussois {

/// What `read` makes of the file if it has all fields of `key` with the same values; nothing if not, if there
/// is no such file, or if it is damaged: then the work is done again.
template <class Read>
auto read_kept(const std::filesystem::path& path, const nlohmann::ordered_json& key, const Read& read)
    -> std::optional<decltype(read(key))> {
  if (!std::filesystem::exists(path)) return {};
  try {
    const auto json = nlohmann::ordered_json::parse(read_file(path));
    for (auto field = key.begin(); field != key.end(); ++field)
      if (json.at(field.key()) != field.value()) return {};
    return read(json);
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace aussois
