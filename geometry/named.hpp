// SPDX-License-Identifier: Apache-2.0
// Translates between enumerators and their names for people.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace aussois {

/// An entry of a table {{value, "name"}, ...}; the functions below look things up in such a table.
template <class Enum>
using Named = std::pair<Enum, const char*>;

template <class Enum, std::size_t n>
const char* name_of(Enum value, const Named<Enum> (&table)[n]) {
  for (const auto& [known, name] : table)
    if (known == value) return name;
  return "?";
}

template <class Enum, std::size_t n>
std::vector<std::string> names_of(const Named<Enum> (&table)[n]) {
  std::vector<std::string> names;
  for (const Named<Enum>& entry : table) names.emplace_back(entry.second);
  return names;
}

/// Throws std::invalid_argument "what = name must be one of ...".
template <class Enum, std::size_t n>
Enum value_named(const std::string& name, const char* what, const Named<Enum> (&table)[n]) {
  std::string all;
  for (const auto& [value, known] : table) {
    if (name == known) return value;
    all += (all.empty() ? "" : ", ") + std::string(known);
  }
  throw std::invalid_argument(std::string(what) + " = " + name + " must be one of " + all);
}

}  // namespace aussois
