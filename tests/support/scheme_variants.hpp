// SPDX-License-Identifier: Apache-2.0
// Settings of schemes as the parameters of tests.
#pragma once

#include <algorithm>

#include "integrators/scheme.hpp"

namespace aussois {

/// Scheme and settings in letters that a test's name may have.
inline std::string test_name(const SchemeVariant& v) {
  std::string out = label(v.name, v.options);
  std::ranges::replace_if(
      out, [](char c) { return c == ' ' || c == '.'; }, '_');
  return out;
}

/// All that run joints: the registry's, the reference, and joints on the mean of both ends.
inline std::vector<SchemeVariant> variants_with_joints() {
  std::vector<SchemeVariant> out = scheme_variants();
  out.push_back({"event_driven", {}});
  SchemeOptions mean{.update = GroupUpdate::cayley};
  mean.mean_joints = true;
  out.push_back({"passive_midpoint", mean});
  for (SchemeVariant& v : out) v.options.solver.tolerance = 1e-12;
  return out;
}

}  // namespace aussois
