// SPDX-License-Identifier: Apache-2.0
// Proves how far the points of one surface are from another at most (LOD-8).
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// No point of the triangles of `from` is farther from those of `to` than this [m]: an upper bound, found by
/// splitting triangles until it is within a quarter of the largest distance seen, or pieces are small against
/// the triangles of both. The same for any number of threads. Throws std::invalid_argument unless both have
/// triangles.
double covering_distance(const SimplicialComplex& from, const SimplicialComplex& to, int threads = 1);

}  // namespace aussois
