// SPDX-License-Identifier: Apache-2.0
#include "geometry/dilated_shape.hpp"

#include <cmath>
#include <utility>

#include "geometry/check.hpp"

namespace aussois {

DilatedShape dilate(SimplicialComplex complex, double radius) {
  require_field(radius >= 0 && std::isfinite(radius), "dilation radius [m]", radius, "be finite and >= 0");
  require_field(!complex.vertices.empty(), "vertex count of the complex", complex.vertices.size(), "be > 0");
  return {std::move(complex), radius};
}

}  // namespace aussois
