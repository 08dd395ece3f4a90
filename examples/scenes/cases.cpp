// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/cases.hpp"

#include <stdexcept>

namespace aussois {

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> out;
    for (const std::vector<Case>& kind :
         {impact_cases(), friction_cases(), rotation_cases(), mechanism_cases()})
      out.insert(out.end(), kind.begin(), kind.end());
    return out;
  }();
  return all;
}

const Case& case_named(const std::string& name) {
  std::string known;
  for (const Case& c : cases()) {
    if (c.name == name) return c;
    known += (known.empty() ? "" : ", ") + c.name;
  }
  throw std::invalid_argument("case = " + name + " must be one of " + known);
}

}  // namespace aussois
