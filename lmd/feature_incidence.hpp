// SPDX-License-Identifier: Apache-2.0
// Tells which features a shape has, and which of them contain which others.
#pragma once

#include "lmd/contact_point.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// How many features of a dimension a shape has: vertices, chains, regions. Their indices are below it.
std::size_t feature_count(const LmdShape& shape, int dim);

/// True if the two are the same, or if one lies in the border of the other: a vertex that ends a chain or is
/// a corner of a region's triangle, or a chain that borders a region. The shape must have both.
bool incident(const LmdShape& shape, const KeyFeature& f, const KeyFeature& g);

}  // namespace aussois
