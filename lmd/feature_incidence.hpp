// SPDX-License-Identifier: Apache-2.0
// Which features of a shape contain which others.
#pragma once

#include "lmd/contact_point.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// True if the two are one, or one lies in the border of the other: a vertex ends a chain or is a corner of a
/// region's triangle, a chain borders a region.
bool incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g);

}  // namespace aussois
