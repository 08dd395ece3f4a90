// SPDX-License-Identifier: Apache-2.0
// Groups the contacts of a body pair whose normals almost agree (RED-2).
#pragma once

#include <span>
#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Indices into the set, the deepest contact of each cluster first. Ties are broken by features, then by
/// coordinates, so that neither the clusters nor their order depend on how the set is stored.
using Clusters = std::vector<std::vector<int>>;

/// `angle`: largest angle of a normal to that of the deepest contact of its cluster [rad], in (0, pi/2].
Clusters clusters_by_angle(const ContactSet& found, double angle);

/// The members of each label, in their order. Labels count from 0; labels without members are left out.
Clusters parts_of(const std::vector<int>& members, const std::vector<int>& label);

/// The leading contacts of a cluster, those within `layer` [m] of the deepest. The cluster has at least one
/// contact.
std::span<const int> closed_layer(const ContactSet& found, std::span<const int> cluster, double layer);

}  // namespace aussois
