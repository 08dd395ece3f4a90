// SPDX-License-Identifier: Apache-2.0
// The rule by which engines reduce a patch to four contacts: the deepest stays, and the quadrilateral with it
// is large. What our reducers are measured against.
#pragma once

#include <span>

#include "reduction/selection.hpp"

namespace aussois {

/// Members of one cluster, the deepest first, as numbers among them, at most four: the deepest, the one
/// farthest from it, the one that makes the largest triangle with both, and the one that adds the largest
/// triangle outside of that.
std::vector<int> patch_of_four(const ContactSet& contacts, std::span<const int> members);

/// The same as a reducer: clusters of more than four are reduced to at most four.
ContactSelector patch_of_four_selector();

}  // namespace aussois
