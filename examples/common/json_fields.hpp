// SPDX-License-Identifier: Apache-2.0
// Reads a JSON text that a user wrote: each field once, none unknown, values within their ranges.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/settings.hpp"
#include "geometry/types.hpp"
#include "io/text.hpp"

namespace aussois {

using Json = nlohmann::ordered_json;

/// Throws std::runtime_error with line and column, and for a field that stands twice in one object.
Json parse_json(const std::string& text);

/// A JSON object whose fields are taken one by one; what is left is refused.
class Fields {
 public:
  Fields(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("", "must be an object");
  }
  bool has(const std::string& name) const { return json_.contains(name); }
  const Json& take(const std::string& name) {
    if (!has(name)) fail(name, "is missing");
    taken_.push_back(name);
    return json_.at(name);
  }
  Fields object(const std::string& name) { return {take(name), inside(name)}; }
  std::string inside(const std::string& name) const { return where_.empty() ? name : where_ + "." + name; }
  double number(const std::string& name, const Range& range) {
    const Json& value = take(name);
    if (!value.is_number()) fail(name, "must be a number");
    if (!contains(range, value.get<double>()))
      fail(name, "= " + value.dump() + " must " + range_order(range));
    return value.get<double>();
  }
  bool flag(const std::string& name, bool otherwise) {
    if (!has(name)) return otherwise;
    const Json& value = take(name);
    if (!value.is_boolean()) fail(name, "must be true or false");
    return value.get<bool>();
  }
  std::string text(const std::string& name) {
    const Json& value = take(name);
    if (!value.is_string()) fail(name, "must be a string");
    return value.get<std::string>();
  }
  static constexpr Range kPlace{-1000, 1000};  // [m]
  Vec3 vector(const std::string& name, const Range& range = kPlace) {
    return vector_in(take(name), name, range);
  }
  Vec3 vector_in(const Json& value, const std::string& name, const Range& range = kPlace) const {
    const bool three = value.is_array() && value.size() == 3 &&
                       std::ranges::all_of(value, [](const Json& x) { return x.is_number(); });
    if (!three) fail(name, "must be three numbers");
    for (const Json& x : value)
      if (!contains(range, x.get<double>())) fail(name, "= " + x.dump() + " must " + range_order(range));
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
  }
  void end() const {
    for (const auto& [name, value] : json_.items())
      if (std::ranges::find(taken_, name) == taken_.end()) fail(aussois::quoted(name), "is unknown");
  }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    const std::string who = name.empty() ? where_ : inside(name);
    throw std::runtime_error((who.empty() ? "the object" : who) + " " + what);
  }

 private:
  const Json& json_;
  std::string where_;
  std::vector<std::string> taken_{};
};

}  // namespace aussois
