// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "integrators/scheme.hpp"

namespace aussois {

/// All that run joints: the registry's, the reference, and joints on the mean of both ends.
inline std::vector<SchemeVariant> variants_with_joints() {
  std::vector<SchemeVariant> out = scheme_variants();
  out.push_back({"event_driven", {}});
  SchemeOptions mean{.step = {.update = GroupUpdate::cayley}};
  mean.passive_midpoint.mean_joints = true;
  out.push_back({"passive_midpoint", mean});
  for (SchemeVariant& v : out) v.options.step.solver.tolerance = 1e-12;
  return out;
}

}  // namespace aussois
