// SPDX-License-Identifier: Apache-2.0
// An order of contacts that does not depend on how their set is stored.
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Indices into the set: body pairs one after the other, the deepest contact of a pair first; then by
/// features and the coordinates of the mid point.
std::vector<int> canonical_order(const ContactSet& found);

}  // namespace aussois
