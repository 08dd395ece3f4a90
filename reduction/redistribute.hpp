// SPDX-License-Identifier: Apache-2.0
// What dropped contacts carried goes to the kept ones of their cluster, so that a change of the selection
// does not lose the load (PER-7).
#pragma once

#include "reduction/reduce.hpp"

namespace aussois {

/// Impulses to start the kept contacts with, world, on A [N s]; zero for the others. `impulse` of all
/// contacts, `mu` their friction. Where no dropped contact of a cluster has one, its kept ones start with
/// their own, bit for bit; elsewhere normal impulses are not negative, tangential ones in the cone.
std::vector<Vec3> redistribute(const ContactSet& contacts, const Selection& selection,
                               const std::vector<Vec3>& impulse, const std::vector<double>& mu);

}  // namespace aussois
