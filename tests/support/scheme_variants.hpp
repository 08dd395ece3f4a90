// SPDX-License-Identifier: Apache-2.0
// Settings of schemes as the parameters of tests.
#pragma once

#include <algorithm>

#include "examples/scenes/joint_variants.hpp"

namespace aussois {

/// Scheme and settings in letters that a test's name may have.
inline std::string test_name(const SchemeVariant& v) {
  std::string out = label(v.name, v.options);
  std::ranges::replace_if(
      out, [](char c) { return c == ' ' || c == '.'; }, '_');
  return out;
}

}  // namespace aussois
