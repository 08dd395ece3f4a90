// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/slid_level.hpp"

#include "examples/common/kept_json.hpp"

namespace aussois {

using Json = nlohmann::ordered_json;

void write_level(const std::filesystem::path& path, const Json& key, const SlidLevel& level) {
  write_kept(path, key, {{"travel_m", number_json(level.travel)}, {"audit", json_of(level.audit)}});
}

std::optional<SlidLevel> read_level(const std::filesystem::path& path, const Json& key) {
  return read_kept(path, key, [](const Json& json) {
    return SlidLevel{number_in(json.at("travel_m")), audit_in(json.at("audit"))};
  });
}

}  // namespace aussois
