// SPDX-License-Identifier: Apache-2.0
// Erodes a solid, trying several ways to order and join the events of the wavefront; the first result that
// passes all checks is taken.
#pragma once

#include "geometry/surface_tree.hpp"
#include "lmd/region_offset.hpp"

namespace aussois {

struct ErosionTrial {
  RegionOffset made{};  // holds what stopped the first way if no way leads to an eroded solid
  SimplicialComplex complex{};
};

/// `tree` is the tree of the solid.
ErosionTrial attempt_erosion(const SimplicialComplex& solid, const SurfaceTree& tree,
                             const Idealisation& ideal, const std::vector<Fan>& fans,
                             const ErosionOptions& options);

/// The part of the depth that the whole eroded surface must keep [m]; the rest forgives digits of files and
/// accepted deviations.
double least_depth(const Wavefront& wave, const ErosionOptions& options, double size);

}  // namespace aussois
