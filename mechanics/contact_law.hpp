// SPDX-License-Identifier: Apache-2.0
// The contact law of a pair of bodies: friction and restitution.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

struct ContactLaw {
  double mu = 0.3;              // Coulomb friction [-], >= 0
  double restitution = 0.0;     // Newton restitution e [-], in [0, 1]
  double contensou_radius = 0;  // R_e of Coulomb-Contensou's ellipsoid: drilling torque up to mu r_N R_e [m],
                                // >= 0; 0: contacts do not resist drilling
  bool operator==(const ContactLaw&) const = default;
};

}  // namespace aussois
