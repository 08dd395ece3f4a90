// SPDX-License-Identifier: Apache-2.0
// A run of sliding_block with steps of one length, kept in a JSON file.
#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "examples/common/run_watch.hpp"

namespace aussois {

struct SlidLevel {
  double travel = 0;  // distance slid down the slope until well after the stop [m]
  RunAudit audit{};
};

/// `key`: what the run depends on.
void write_level(const std::filesystem::path& path, const nlohmann::ordered_json& key,
                 const SlidLevel& level);
/// Nothing: not there, damaged, or of another key.
std::optional<SlidLevel> read_level(const std::filesystem::path& path, const nlohmann::ordered_json& key);

}  // namespace aussois
