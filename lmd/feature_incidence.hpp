// SPDX-License-Identifier: Apache-2.0
// Tells which features of a shape contain which others.
#pragma once

#include "lmd/contact_point.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// True if the two are the same, or if one lies in the border of the other: a vertex that ends a chain or is
/// a corner of a region's triangle, or a chain that borders a region.
bool incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g);

}  // namespace aussois
