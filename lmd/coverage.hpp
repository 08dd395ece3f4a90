// SPDX-License-Identifier: Apache-2.0
// Do the contacts of a pair cover the space around its bases? Judged by the distance of the bases, which
// knows no regions, chains and cones (LMD-14).
#pragma once

#include "lmd/posed_shape.hpp"

namespace aussois {

/// By how much the smallest gap of the pair lies above `distance` less the dilations [m], `distance` > 0
/// being that of the base complexes; infinity: no contact there at all, as of nested bodies. Negative: a
/// contact is nearer than the bases.
double gap_beyond_distance(const PosedShape& a, const PosedShape& b, double distance, int threads = 1);

/// (LMD-14) of one pose. Bases that all but touch have no direction, and no contact: they count as covered.
bool is_covered(const PosedShape& a, const PosedShape& b, double distance, int threads = 1);

/// The same of a smallest gap that a search has found, with a threshold of at least `distance` less the
/// dilations and coverage_tolerance.
bool is_covered_by(double smallest_gap, const LmdShape& a, const LmdShape& b, double distance);

/// What idealised planes and chains may make of it, either way (LMD-14) [m].
double coverage_tolerance(const LmdShape& a, const LmdShape& b);

}  // namespace aussois
