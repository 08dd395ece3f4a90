// SPDX-License-Identifier: Apache-2.0
// Numbers as messages and files show them.
#pragma once

#include <cstdint>
#include <string>

namespace aussois {

/// The shortest decimal form that reads back as the same double, whatever the locale.
std::string number_text(double value);

/// "1 step", "2 steps"; `many` where the plural is not made by an s: "2 vertices".
std::string counted(std::int64_t count, const std::string& one, const std::string& many = {});

}  // namespace aussois
