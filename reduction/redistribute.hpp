// SPDX-License-Identifier: Apache-2.0
// Passes what dropped contacts carried to the kept ones of their cluster, so that a change of the selection
// does not lose the load (PER-7).
#pragma once

#include "reduction/reduce.hpp"

namespace aussois {

/// Impulses that the kept contacts start with, world, on A [N s]; zero for the others. `impulse` has those of
/// all contacts, `mu` their friction. If no dropped contact of a cluster has an impulse, its kept contacts
/// start with their own, bit for bit. Otherwise normal impulses are not negative, and tangential ones lie in
/// the cone.
std::vector<Vec3> redistribute(const ContactSet& contacts, const Selection& selection,
                               const std::vector<Vec3>& impulse, const std::vector<double>& mu);

}  // namespace aussois
