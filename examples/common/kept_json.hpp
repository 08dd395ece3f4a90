// SPDX-License-Identifier: Apache-2.0
// Results that a study keeps in JSON files, each beside the key by which a later call finds it again. A file
// appears when it is complete, so an interrupted study loses nothing that it wrote.
#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "geometry/settings.hpp"
#include "io/text.hpp"

namespace aussois {

/// The fields of `key`, then the others of `fields`: the key wins over a field of the same name.
nlohmann::ordered_json with_key(const nlohmann::ordered_json& key, const nlohmann::ordered_json& fields);
/// JSON as the text of a file. Bytes that are no UTF-8 are replaced.
std::string file_text(const nlohmann::ordered_json& json);

/// Numbers in JSON, which has none that are infinite or no number: they are the texts "inf", "-inf" and
/// "nan". All others come back to the last bit. Reading throws std::exception for anything else.
nlohmann::ordered_json number_json(double value);
double number_in(const nlohmann::ordered_json& json);

/// The options that a result depends on, by their paths in the table; a value that is no JSON is a text.
nlohmann::ordered_json settings_json(const std::vector<SettingValue>& values);
template <class Options>
nlohmann::ordered_json settings_json(const Options& options) {
  return settings_json(values_of(options));
}

/// Writes with_key(key, fields), so that read_kept finds it with this key. The numbers of a key are finite.
void write_kept(const std::filesystem::path& path, const nlohmann::ordered_json& key,
                const nlohmann::ordered_json& fields);

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
