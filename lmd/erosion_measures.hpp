// SPDX-License-Identifier: Apache-2.0
// Measures how well the dilation of an eroded solid restores the solid (ERO-6) to (ERO-8), on dense samples.
#pragma once

#include <functional>

#include "geometry/surface_tree.hpp"
#include "lmd/erosion.hpp"

namespace aussois {

/// The shortest way through a solid from a face to one within 30 degrees of parallel.
struct Thickness {
  double value = kInf;        // [m]
  Vec3 place = Vec3::Zero();  // [m]
  int triangle = -1;
};
Thickness smallest_thickness(const SimplicialComplex& solid, const SurfaceTree& tree, int samples);

/// Fills shallow, face_error, rounding, hausdorff, thickness and samples. `restored(triangle, x, foot)` says
/// whether the dilation should restore a sample of the solid; `inner` is the tree of the eroded solid.
using IsRestored = std::function<bool(int triangle, const Vec3& x, const SurfacePoint& foot)>;
ErosionMeasures measure_erosion_where(const SimplicialComplex& solid, const SimplicialComplex& eroded,
                                      const SurfaceTree& inner, double depth, int samples,
                                      const IsRestored& restored);

}  // namespace aussois
