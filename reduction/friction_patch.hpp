// SPDX-License-Identifier: Apache-2.0
// Where the friction of a patch acts as a whole, and how far out (RED-15).
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

struct FrictionPatch {
  Vec3 centre = Vec3::Zero();  // of the hull of the closed contacts of the cluster, world [m]
  double radius = 0;           // drilling radius of that hull [m] (RED-8); 0: a single point
};

/// One per contact: the patch that it is part of. Contacts within `layer` [m] of the deepest of their cluster
/// (RED-2) make up one patch, any other contact is one by itself.
std::vector<FrictionPatch> friction_patches(const ContactSet& found, double cluster_angle, double layer);

}  // namespace aussois
