// SPDX-License-Identifier: Apache-2.0
// The summary of a run: the few numbers that scripts read, under ordered keys, written as JSON.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace aussois {

using SummaryValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                                  std::vector<double>, std::vector<std::string>>;

struct Summary {
  std::vector<std::pair<std::string, SummaryValue>>
      entries{};  // keys are unique, in the order of their first `set`

  /// Replaces the value of a known key in place, else appends. Throws std::invalid_argument for an empty key.
  void set(const std::string& key, SummaryValue value);
  void set(const std::string& key, const char* text) { set(key, SummaryValue(std::string(text))); }
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) void set(const std::string& key, Integer value) {
    set(key, SummaryValue(std::int64_t(value)));
  }
};

/// JSON text with one line per key; doubles read back as the same bits; numbers that are not finite become
/// null; bytes that are not UTF-8 become U+FFFD.
std::string to_json(const Summary& summary);

/// Writes to_json atomically (see write_whole_file). Throws std::runtime_error with the path.
void write_summary(const std::filesystem::path& path, const Summary& summary);

}  // namespace aussois
