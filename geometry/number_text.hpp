// SPDX-License-Identifier: Apache-2.0
// Writes numbers as messages and files show them. Inline: rooms that link with no other show numbers too.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>

namespace aussois {

/// The shortest decimal form that reads back as the same double, whatever the locale.
inline std::string number_text(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

/// "1 step", "2 steps"; `many` if the plural is not formed with an s: "2 vertices".
inline std::string counted_noun(std::int64_t count, const std::string& one, const std::string& many = {}) {
  return std::to_string(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

}  // namespace aussois
