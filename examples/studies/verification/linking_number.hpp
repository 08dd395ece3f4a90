// SPDX-License-Identifier: Apache-2.0
// The linking number of two closed polygons: how often one winds about the other. Only what goes through
// itself changes it.
#pragma once

#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Gauss's integral, summed over pairs of segments by the solid angles under which they see each other
/// (Klenin and Langowski, Biopolymers 54 (2000), method 1a). A whole number to rounding if the polygons do
/// not meet.
double linking_number(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace aussois
