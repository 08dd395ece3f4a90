// SPDX-License-Identifier: Apache-2.0
// The contact law of a pair of bodies: friction and restitution.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct ContactLaw {
  double mu = 0.3;              // Coulomb friction [-]
  double restitution = 0.0;     // Newton restitution e [-]
  double contensou_radius = 0;  // R_e of Coulomb-Contensou's ellipsoid: drilling torque up to mu r_N R_e [m];
                                // 0: contacts do not resist drilling
  bool operator==(const ContactLaw&) const = default;
};
void describe(SettingVisitor& visit, ContactLaw& law);

}  // namespace aussois
