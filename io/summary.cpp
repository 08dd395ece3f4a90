// SPDX-License-Identifier: Apache-2.0
#include "io/summary.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"

namespace aussois {

void Summary::set(const std::string& key, SummaryValue value) {
  require(!key.empty(), "Summary::set: the key must not be empty");
  const auto known =
      std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == key; });
  if (known == entries.end())
    entries.emplace_back(key, std::move(value));
  else
    known->second = std::move(value);
}

std::string to_json(const Summary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [key, value] : summary.entries)
    std::visit([&json, &name = key](const auto& v) { json[name] = v; }, value);
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  write_whole_file(path, to_json(summary));
}

}  // namespace aussois
