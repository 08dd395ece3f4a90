// SPDX-License-Identifier: Apache-2.0
// Where the friction of a whole patch acts, and at what radius (RED-15).
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

struct FrictionPatch {
  Vec3 centre = Vec3::Zero();  // of the hull of the closed contacts of the cluster, world [m]
  double radius = 0;           // drilling radius of that hull [m] (RED-8); 0: a single point
};

/// For each contact, the patch that it belongs to. Contacts within `layer` [m] of the deepest of their
/// cluster (RED-2) form one patch; any other contact is a patch by itself.
std::vector<FrictionPatch> friction_patches(const ContactSet& found, double cluster_angle, double layer);

}  // namespace aussois
