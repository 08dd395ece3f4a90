// SPDX-License-Identifier: Apache-2.0
#include "examples/common/json_fields.hpp"

#include <set>

namespace aussois {

Json parse_json(const std::string& text) {
  std::vector<std::set<std::string>> open;  // the fields of each object around the place that is parsed
  const auto each_field_once = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw std::runtime_error(aussois::quoted(value.get<std::string>()) + " stands twice in one object");
    return true;
  };
  return Json::parse(text, each_field_once);
}

}  // namespace aussois
