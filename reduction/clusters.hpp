// SPDX-License-Identifier: Apache-2.0
// Contacts of one body pair whose normals almost agree (RED-2).
#pragma once

#include <span>
#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Indices into the set, the deepest contact of each cluster first; ties by features, then by coordinates, so
/// that neither clusters nor their order depend on how the set is stored.
using Clusters = std::vector<std::vector<int>>;

/// `angle`: largest angle of a normal to that of its cluster's deepest contact [rad], in (0, pi/2].
Clusters clusters_of(const ContactSet& found, double angle);

/// The members of each label, which count from 0, in their order; none without members.
Clusters parts_of(const std::vector<int>& members, const std::vector<int>& label);

/// Its first contacts, within `layer` [m] of the deepest; the cluster has at least one.
std::span<const int> closed_layer(const ContactSet& found, std::span<const int> cluster, double layer);

}  // namespace aussois
