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

/// Takes the restitution out of contacts and stops if the scheme is plastic and would refuse it.
inline void drop_refused_restitution(Model& model, const SchemeVariant& v) {
  if (scheme_traits(v.name, v.options).restitution) return;
  model.contact_law.restitution = 0;
  for (auto& [bodies, law] : model.pair_laws) law.restitution = 0;
  for (Joint& joint : model.joints)
    for (JointAxis& axis : joint.axis) axis.restitution = 0;
}

}  // namespace aussois
