// SPDX-License-Identifier: Apache-2.0
// The one concept of shape: all points within `radius` of a complex (CPX-3).
// A ball is a dilated point, a cable a dilated polyline, a part a dilated surface.
#pragma once

#include "geometry/simplicial_complex.hpp"

namespace aussois {

struct DilatedShape {
  SimplicialComplex complex{};
  double radius = 0;  // dilation [m], >= 0
};

/// Throws std::invalid_argument unless radius is finite and >= 0 and the complex has a vertex.
DilatedShape dilate(SimplicialComplex complex, double radius);

}  // namespace aussois
