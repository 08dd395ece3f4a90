// SPDX-License-Identifier: Apache-2.0
// Checks that the contacts of a pair cover the space around its bases. The reference is the distance of the
// bases, which does not depend on regions, chains or cones (LMD-14).
#pragma once

#include "lmd/posed_shape.hpp"

namespace aussois {

/// How far the smallest gap of the pair lies above `distance` less the dilations [m]; `distance` > 0 is that
/// of the base complexes. Negative: a contact is nearer than the bases. Infinity: there is no contact at all,
/// as for nested bodies.
double gap_beyond_distance(const PosedShape& a, const PosedShape& b, double distance, int threads = 1);

/// Bases that all but touch have no direction, hence no contact; (LMD-14) says nothing of them.
bool bases_all_but_touch(const LmdShape& a, const LmdShape& b, double distance);

/// Whether (LMD-14) holds at one pose; also true for bases that all but touch.
bool is_covered(const PosedShape& a, const PosedShape& b, double distance, int threads = 1);

/// The same for the smallest gap found by a search with a threshold of at least `distance` less the
/// dilations, plus coverage_tolerance.
bool is_covered_by(double smallest_gap, const PosedShape& a, const PosedShape& b, double distance);

/// How far idealised planes and chains, and rounding, may shift the smallest gap, either way (LMD-14) [m].
double coverage_tolerance(const PosedShape& a, const PosedShape& b);

/// How far rounding may shift any distance of the two shapes: 1e-14 of where they stand and how large they
/// are [m].
double rounding_of_distance(const PosedShape& a, const PosedShape& b);

}  // namespace aussois
