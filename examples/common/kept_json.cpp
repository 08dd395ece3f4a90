// SPDX-License-Identifier: Apache-2.0
#include "examples/common/kept_json.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/types.hpp"
#include "io/atomic_file.hpp"

namespace aussois {

using Json = nlohmann::ordered_json;

Json with_key(const Json& key, const Json& fields) {
  Json out = key;
  for (const auto& [name, value] : fields.items())
    if (!out.contains(name)) out[name] = value;
  return out;
}

std::string file_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json number_json(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double number_in(const Json& json) {
  if (json.is_number()) return json.get<double>();
  const std::string text = json.get<std::string>();  // throws if it is no text
  if (text == "inf") return kInf;
  if (text == "-inf") return -kInf;
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  throw std::invalid_argument(aussois::quoted(text) + " is not a number");
}

Json settings_json(const std::vector<SettingValue>& values) {
  Json out = Json::object();
  for (const SettingValue& one : values) {
    if (one.setting.changes_nothing) continue;
    const Json value = Json::parse(one.value, nullptr, false);
    out[one.path] = value.is_discarded() ? Json(one.value) : value;
  }
  return out;
}

void write_kept(const std::filesystem::path& path, const Json& key, const Json& fields) {
  write_whole_file(path, file_text(with_key(key, fields)));
}

}  // namespace aussois
